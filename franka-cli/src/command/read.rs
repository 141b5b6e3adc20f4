//! `franka read`: prints fields of the state by name.

use clap::Args;
use serde_json::{Map, Value, json};

use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::fields::{fields, values};
use crate::output::Output;

/// Print fields of the robot's state
///
/// Fields have the vendor's names, as in `franka read q O_T_EE`. A first argument that is not a
/// field is the robot.
#[derive(Debug, Args)]
pub(crate) struct Read {
    /// Name or address of the robot (optional), then fields
    #[arg(value_name = "[ROBOT] FIELD", required_unless_present = "list")]
    words: Vec<String>,
    /// List the fields
    #[arg(long, conflicts_with = "words")]
    list: bool,
    #[command(flatten)]
    output: Output,
}

impl Read {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        if self.list {
            let names: Vec<String> = fields().keys().cloned().collect();
            return self
                .output
                .print(&json!({ "fields": names }), || names.join("\n"));
        }
        let known = fields();
        let (robot, names) = match self.words.split_first() {
            Some((first, rest)) if !known.contains_key(first) => (Some(first.clone()), rest),
            _ => (None, &self.words[..]),
        };
        if let Some(unknown) = names.iter().find(|name| !known.contains_key(*name)) {
            return Err(unknown_field(unknown).into());
        }
        if names.is_empty() {
            let first = robot.unwrap_or_default();
            return Err(unknown_field(&first).into());
        }
        let (robot, _) = Which::of(robot).connect().await?;
        let mut state = values(&robot.state());
        robot.shutdown().await;
        let chosen: Map<String, Value> = names
            .iter()
            .filter_map(|name| Some((name.clone(), state.remove(name)?)))
            .collect();
        self.output.print(&chosen, || {
            let lines = names
                .iter()
                .map(|name| format!("{name} = {}\n", chosen[name]));
            lines.collect()
        })
    }
}

fn unknown_field(name: &str) -> Failure {
    Failure::usage(format!("the state has no field `{name}`"))
        .advice("franka read --list shows all fields. Put the robot before the fields.")
}
