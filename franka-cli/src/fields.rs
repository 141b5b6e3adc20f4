//! A state by the vendor's names of its fields.

use franka_async::state::RobotState;
use serde_json::{Map, Value};

/// The fields, with values that mean nothing.
pub(crate) fn fields() -> Map<String, Value> {
    values(&RobotState::default())
}

/// A state by its fields.
pub(crate) fn values(state: &RobotState) -> Map<String, Value> {
    match serde_json::to_value(state) {
        Ok(Value::Object(fields)) => fields,
        other => unreachable!("a state has fields: {other:?}"),
    }
}
