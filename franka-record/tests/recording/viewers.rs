//! The layout for Foxglove and the blueprint for Rerun match the contents of a recording.

use std::collections::BTreeSet;

use franka_model::RobotKind;
use franka_record::recorder::{Recorder, Robot};
use franka_record::schema::{Message as _, franka};
use prost_types::FileDescriptorSet;
use serde_json::Value;

use crate::feed::{Arm, Scratch, quick};

const LAYOUT: &str = include_str!("../../viewers/foxglove.json");
const BLUEPRINT: &str = include_str!("../../viewers/rerun_blueprint.py");

/// Returns a recording of a single robot.
fn recorded() -> Vec<u8> {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let recorder = Recorder::to_file(&path, quick()).unwrap();
    let (mut arm, _) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    arm.run(&recorder, 1);
    recorder.finish().unwrap();
    std::fs::read(path).unwrap()
}

/// Returns the channels of the recording.
fn channels() -> BTreeSet<String> {
    let bytes = recorded();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let channels = summary.channels.values();
    channels.map(|channel| channel.topic.clone()).collect()
}

/// Collects every text in a JSON value.
fn texts(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::String(text) => found.push(text.clone()),
        Value::Array(values) => values.iter().for_each(|value| texts(value, found)),
        Value::Object(fields) => {
            found.extend(fields.keys().cloned());
            fields.values().for_each(|value| texts(value, found));
        }
        _ => {}
    }
}

#[test]
fn the_layout_names_only_channels_and_fields_that_exist() {
    let layout: Value = serde_json::from_str(LAYOUT).unwrap();
    let mut all = Vec::new();
    texts(&layout, &mut all);
    let descriptors = FileDescriptorSet::decode(franka_record::schema::DESCRIPTORS).unwrap();
    let messages = descriptors.file.iter().flat_map(|file| &file.message_type);
    let cycle = messages
        .clone()
        .find(|message| message.name() == "Cycle")
        .unwrap();
    assert!(franka::Cycle::default().q.is_empty());
    let known = channels();
    let (mut paths, mut topics) = (0, 0);
    for text in all.iter().filter(|text| text.starts_with('/')) {
        let (topic, path) = text.split_once('.').unwrap_or((text, ""));
        assert!(known.contains(topic), "{text}");
        topics += 1;
        if !path.is_empty() {
            let field = path.split('[').next().unwrap();
            assert!(
                cycle.field.iter().any(|known| known.name() == field),
                "{text}"
            );
            paths += 1;
        }
    }
    assert!(topics >= 10 && paths >= 9, "{topics}, {paths}");
    // Each panel of the layout is described, and each description has a panel.
    let panels = layout["configById"].as_object().unwrap();
    let mut shown = Vec::new();
    texts(&layout["layout"], &mut shown);
    for panel in panels.keys() {
        assert!(shown.contains(panel), "{panel}");
    }
}

#[test]
fn the_blueprint_names_only_channels_that_exist() {
    let known = channels();
    let texts = BLUEPRINT.split('"').skip(1).step_by(2);
    let channel = |text: &&str| text.starts_with('/') && !text.contains('{');
    let named: Vec<_> = texts.filter(channel).collect();
    assert_eq!(named.len(), 3, "{named:?}");
    for channel in named {
        assert!(known.contains(channel), "{channel}");
    }
}

/// A viewer derives the id of an MCAP file from its path, and draws no frame without axes.
#[test]
fn the_blueprint_is_saved_for_the_id_that_the_book_converts_to() {
    let id = |text: &str, before: &str| {
        let (_, rest) = text.split_once(before).expect("it is named");
        let end = rest.find(|it: char| it == '"' || it.is_whitespace());
        rest[..end.expect("an end")].to_owned()
    };
    let saved = id(BLUEPRINT, "APPLICATION_ID = \"");
    let option = "rerun mcap convert run.mcap --application-id ";
    assert_eq!(id(BLUEPRINT, option), saved);
    assert_eq!(
        id(include_str!("../../../docs/src/recording.md"), option),
        saved
    );
    assert!(BLUEPRINT.contains(".save(APPLICATION_ID, "));
    assert!(BLUEPRINT.contains("overrides={frames: rr.TransformAxes3D("));
    // The base of an arm is the root of its frames, and views find the frames by their root.
    let bytes = recorded();
    let mut messages = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let frames = messages.find(|message| message.channel.topic == "/tf");
    let frames = String::from_utf8_lossy(&frames.unwrap().data).into_owned();
    assert!(frames.contains("fr3_link0"), "{frames}");
    assert!(BLUEPRINT.contains("target_frame=f\"{robot}_link0\""));
}
