//! The tables of the dissector: written from the layouts that franka-proto is tested with, so that
//! they are maintained once.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// Commands whose reply follows at the end of an action.
const LONG: [&str; 7] = [
    "Move",
    "AutomaticErrorRecovery",
    "Homing",
    "Grasp",
    "Vacuum",
    "DropOff",
    "Stop",
];

const BEGIN: &str = "-- begin of the tables";
const END: &str = "-- end of the tables";

/// With `FRANKA_WRITE_TABLES` set, the test writes them again.
#[test]
fn the_dissector_has_the_tables_of_the_protocol() {
    let path = dissector();
    let text = std::fs::read_to_string(&path).expect("a text");
    let begin = text.find(BEGIN).expect("a mark");
    let begin = begin + text[begin..].find('\n').expect("a line") + 1;
    let end = text.find(END).expect("a mark");
    let tables = tables();
    if std::env::var_os("FRANKA_WRITE_TABLES").is_some() {
        let new = [&text[..begin], &tables, &text[end..]].concat();
        std::fs::write(&path, new).expect("a writable folder");
        return;
    }
    assert_eq!(text[begin..end], tables, "run with FRANKA_WRITE_TABLES=1");
}

pub(crate) fn dissector() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.join("franka-record/wireshark/franka.lua")
}

fn tables() -> String {
    let mut lua = "local PROTOCOLS = {\n".to_owned();
    for (file, name, prefix) in [
        ("wire_v10", "robot", "franka"),
        ("wire_v5", "robot", "franka"),
        ("wire_gripper", "hand", "franka.hand"),
        ("wire_vacuum_gripper", "vacuum gripper", "franka.vacuum"),
    ] {
        protocol(&mut lua, &layouts(file), name, prefix);
    }
    lua.push_str("}\nlocal ERRORS = {\n");
    let errors = layouts("wire_v10");
    let errors = list(&errors, "errors").map(|error| {
        let index = &error["index"];
        format!("[{index}] = {:?},", text(error, "name"))
    });
    wrapped(&mut lua, 2, errors);
    lua.push_str("}\n");
    lua
}

fn protocol(lua: &mut String, layouts: &Value, name: &str, prefix: &str) {
    let mut line = |indent: usize, line: String| {
        writeln!(lua, "{:indent$}{line}", "").expect("a string takes it");
    };
    let version = layouts.get("fci_version").unwrap_or(&layouts["version"]);
    let (port, header) = (&layouts["tcp_port"], &layouts["header_size"]);
    let state = text(layouts, "state_struct");
    let command = layouts["command_struct"].as_str();
    let of_command = command.map_or(String::new(), |name| format!(" command = {name:?},"));
    line(2, "{".to_owned());
    line(
        4,
        format!(
            "name = {name:?}, prefix = {prefix:?}, version = {version}, port = {port}, header = {header},"
        ),
    );
    line(4, format!("state = {state:?},{of_command}"));
    line(4, "commands = {".to_owned());
    let mut used = vec![state];
    used.extend(command);
    for command in list(layouts, "commands") {
        let name = plain(text(command, "name"));
        let request = command["request"].as_str();
        let response = text(command, "response");
        used.extend(request);
        used.push(response);
        let request = request.map_or("nil".to_owned(), |name| format!("{name:?}"));
        let long = if LONG.contains(&name) {
            ", long = true"
        } else {
            ""
        };
        let id = &command["id"];
        line(
            6,
            format!("[{id}] = {{ {name:?}, {request}, {response:?}{long} }},"),
        );
    }
    lua.push_str("    },\n    enums = {\n");
    for one in list(layouts, "enums") {
        let values = one["values"].as_object().expect("values");
        let mut values: Vec<_> = values.iter().map(|(name, value)| (value, name)).collect();
        values.sort_by_key(|(value, _)| value.as_u64());
        let values = values.into_iter();
        let values = values.map(|(value, name)| format!("[{value}] = {:?},", plain(name)));
        table(lua, text(one, "name"), values);
    }
    lua.push_str("    },\n    structs = {\n");
    for one in list(layouts, "structs") {
        if !used.contains(&text(one, "name")) {
            continue;
        }
        // The data after a struct with a separate length is not part of the table.
        let fields = list(one, "fields").filter(|field| field["count"].is_u64());
        let fields = fields.map(|field| {
            let (name, kind, count) = (text(field, "name"), text(field, "type"), &field["count"]);
            let of = field["enum"].as_str();
            let of = of.map_or(String::new(), |name| format!(", {name:?}"));
            format!("{{ {name:?}, {kind:?}, {count}{of} }},")
        });
        table(lua, text(one, "name"), fields);
    }
    lua.push_str("    },\n  },\n");
}

/// A table of this name, in one line if it fits.
fn table(lua: &mut String, name: &str, items: impl Iterator<Item = String>) {
    let items: Vec<_> = items.collect();
    let line = format!("      [{name:?}] = {{ {} }},", items.join(" "));
    if line.len() <= WIDTH {
        writeln!(lua, "{line}").expect("a string takes it");
        return;
    }
    writeln!(lua, "      [{name:?}] = {{").expect("a string takes it");
    wrapped(lua, 8, items.into_iter());
    lua.push_str("      },\n");
}

/// The items in lines of limited width.
fn wrapped(lua: &mut String, indent: usize, items: impl Iterator<Item = String>) {
    let mut line = String::new();
    for item in items {
        if !line.is_empty() && indent + line.len() + 1 + item.len() > WIDTH {
            writeln!(lua, "{:indent$}{line}", "").expect("a string takes it");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(&item);
    }
    if !line.is_empty() {
        writeln!(lua, "{:indent$}{line}", "").expect("a string takes it");
    }
}

fn layouts(file: &str) -> Value {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors");
    let text = std::fs::read_to_string(folder.join(format!("{file}.json")));
    serde_json::from_str(&text.expect("a vector file")).expect("JSON")
}

fn list<'a>(value: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> {
    value[key].as_array().expect("a list").iter()
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().expect("a text")
}

/// An enumerator without the vendor's prefix.
fn plain(name: &str) -> &str {
    name.strip_prefix('k').unwrap_or(name)
}

const WIDTH: usize = 118;
