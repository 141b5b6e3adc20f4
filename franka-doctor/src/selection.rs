//! Selection of checks.

/// A selection of checks by id, or by the part of the id before the dot. For example, `nic` selects
/// `nic.route` and all other checks of the network card. The default selects all checks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    only: Vec<String>,
    skip: Vec<String>,
}

impl Selection {
    /// Selects the checks in `only` (or all checks if `only` is empty), except the checks in
    /// `skip`.
    pub fn new(only: Vec<String>, skip: Vec<String>) -> Self {
        Self { only, skip }
    }

    /// Returns true if the check with this id is selected.
    pub fn takes(&self, id: &str) -> bool {
        let names = |names: &[String]| {
            names.iter().any(|name| {
                let rest = id.strip_prefix(name.as_str());
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            })
        };
        (self.only.is_empty() || names(&self.only)) && !names(&self.skip)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_taken_whole_or_up_to_a_dot() {
        let of = |only: &[&str], skip: &[&str]| {
            let owned = |names: &[&str]| names.iter().map(ToString::to_string).collect();
            Selection::new(owned(only), owned(skip))
        };
        for (selection, id, expected) in [
            (of(&[], &[]), "nic.route", true),
            (of(&["nic"], &[]), "nic.route", true),
            (of(&["ni"], &[]), "nic.route", false),
            (of(&["nic.route"], &[]), "nic.kind", false),
            (of(&["nic"], &["nic.kind"]), "nic.kind", false),
            (of(&[], &["timing"]), "timing.wake_up", false),
            (of(&["clock"], &["clock.sync"]), "clock", true),
        ] {
            assert_eq!(selection.takes(id), expected, "{selection:?} {id}");
        }
    }
}
