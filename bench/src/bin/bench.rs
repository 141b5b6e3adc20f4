//! Runs the benchmarks, or those whose keys begin with `PREFIX`:
//! `bench OUTPUT.json [ROUNDS [PREFIX]]`. Prints the values and writes them as one flat JSON
//! object.

use std::env;
use std::fs;
use std::process::ExitCode;

use franka_bench as bench;

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1);
    let rounds = |text: Option<String>| text.map_or(Ok(ROUNDS), |text| text.parse());
    let (Some(output), Ok(rounds)) = (arguments.next(), rounds(arguments.next())) else {
        eprintln!("usage: bench OUTPUT.json [ROUNDS [PREFIX]]");
        return ExitCode::from(2);
    };
    let prefix = arguments.next().unwrap_or_default();
    let mut benchmarks = bench::all();
    benchmarks.retain(|benchmark| benchmark.key.starts_with(&prefix));
    let values = bench::measure(&mut benchmarks, rounds);
    for (key, value) in &values {
        println!("{key:<28} {value:>9}");
    }
    let mut json = serde_json::json!(values);
    if FOLLOW.starts_with(&prefix) {
        let lag = franka_tests::follow::lag(10, true).reference;
        println!("{FOLLOW} {lag:.2}");
        json[FOLLOW] = lag.into();
    }
    if RECORD.starts_with(&prefix) || prefix.starts_with(RECORD) {
        let cost = bench::record::record(1.0, false, &env::temp_dir());
        let mut put = |key: &str, value: f64| {
            println!("{key:<28} {value:>9.2}");
            json[key] = value.into();
        };
        put("record.bytes_per_cycle", cost.bytes_per_cycle);
        put("record.dropped", cost.dropped as f64);
        if let Some(percent) = cost.cpu_percent {
            put("record.cpu_percent", percent);
        }
    }
    if let Err(error) = fs::write(&output, format!("{json:#}\n")) {
        eprintln!("cannot write {output}: {error}");
        return ExitCode::FAILURE;
    }
    println!("medians over {rounds} rounds, written to {output}");
    ExitCode::SUCCESS
}

/// Key of the lag behind a moving target, `[ms]`: the same in every round.
const FOLLOW: &str = "follow.lag_ms_constant_velocity";

/// First part of the keys of a recording of one minute: bytes, and percent of one core at 1 kHz.
const RECORD: &str = "record.";

/// Number of rounds, sufficient for a median that two disturbed rounds do not change.
const ROUNDS: usize = 15;
