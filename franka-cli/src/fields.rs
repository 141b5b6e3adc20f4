//! Converts a state to a map whose keys are the vendor's field names.

use franka_async::state::RobotState;
use serde_json::{Map, Value};

/// Returns a map of all fields, with arbitrary values.
pub(crate) fn fields() -> Map<String, Value> {
    values(&RobotState::default())
}

pub(crate) fn values(state: &RobotState) -> Map<String, Value> {
    match serde_json::to_value(state) {
        Ok(Value::Object(fields)) => fields,
        other => unreachable!("a state has fields: {other:?}"),
    }
}
