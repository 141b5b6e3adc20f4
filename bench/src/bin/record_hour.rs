//! Records a realistic arm for `MINUTES` of virtual time, complete and thinned, and prints the
//! totals: `record_hour [MINUTES [DIRECTORY]]`, 60 minutes in the directory for temporary files.

use std::env;
use std::path::PathBuf;
use std::process::ExitCode;

use franka_bench::record::record;

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1);
    let minutes = arguments.next().map_or(Ok(60.0), |text| text.parse());
    let Ok(minutes) = minutes else {
        eprintln!("usage: record_hour [MINUTES [DIRECTORY]]");
        return ExitCode::from(2);
    };
    let directory = arguments.next().map_or_else(env::temp_dir, PathBuf::from);
    let mut dropped = 0;
    for thinned in [false, true] {
        let cost = record(minutes, thinned, &directory);
        let kind = if thinned { "thinned" } else { "whole" };
        println!("{kind}: {}", serde_json::json!(cost));
        dropped += cost.dropped;
    }
    ExitCode::from(u8::from(dropped > 0))
}
