//! A state by the vendor's names of its fields.

use franka_async::state::RobotState;
use serde_json::{Map, Value};

/// Returns the fields, with meaningless values.
pub(crate) fn fields() -> Map<String, Value> {
    values(&RobotState::default())
}

/// Returns a state by its fields.
pub(crate) fn values(state: &RobotState) -> Map<String, Value> {
    match serde_json::to_value(state) {
        Ok(Value::Object(fields)) => fields,
        other => unreachable!("a state has fields: {other:?}"),
    }
}
