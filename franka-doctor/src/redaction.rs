//! Removes names that identify a person or a device from texts.

/// Replacements for names that identify a person or a device.
#[derive(Clone, Debug, Default)]
pub(crate) struct Redaction {
    names: Vec<String>,
}

impl Redaction {
    /// Creates the replacements for a host. `passwd` is the text of `/etc/passwd`, which contains
    /// the personal accounts.
    pub(crate) fn new(passwd: &str) -> Self {
        let person = |line: &str| {
            let fields: Vec<&str> = line.split(':').collect();
            let id: u32 = fields.get(2)?.parse().ok()?;
            (PEOPLE.contains(&id)).then(|| fields[0].to_owned())
        };
        Self {
            names: passwd.lines().filter_map(person).collect(),
        }
    }

    /// Returns `text` with personal names, hardware addresses, UUIDs and serial numbers replaced.
    pub(crate) fn apply(&self, text: &str) -> String {
        let mut result = String::with_capacity(text.len());
        let mut rest = text;
        while !rest.is_empty() {
            let end = rest.find(|c: char| !is_of_word(c)).unwrap_or(rest.len());
            // Punctuation at the end of a word belongs to the sentence or the list.
            let end = rest[..end].trim_end_matches([':', '.']).len();
            if end > 0 {
                let serial = result.to_lowercase().ends_with("serial=");
                result += match &rest[..end] {
                    _ if serial => "(serial)",
                    word if is_hardware_address(word) => "(hardware address)",
                    word if is_uuid(word) => "(uuid)",
                    word if self.names.iter().any(|name| name == word) => "(user)",
                    word => word,
                };
            }
            let mut after = rest[end..].chars();
            result.extend(after.next());
            rest = after.as_str();
        }
        result
    }
}

/// Range of the user ids of personal accounts. All distributions use it by default.
const PEOPLE: core::ops::Range<u32> = 1000..60_000;

fn is_of_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || "-_:.".contains(c)
}

fn is_hex(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

fn is_hardware_address(word: &str) -> bool {
    let parts: Vec<&str> = word.split(':').collect();
    parts.len() == 6 && parts.iter().all(|part| part.len() == 2 && is_hex(part))
}

fn is_uuid(word: &str) -> bool {
    let parts: Vec<&str> = word.split('-').collect();
    parts.len() == 5
        && parts
            .iter()
            .zip([8, 4, 4, 4, 12])
            .all(|(part, length)| part.len() == length && is_hex(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_and_devices_are_replaced_and_nothing_else() {
        let passwd = "root:x:0:0:root:/root:/bin/sh\nann:x:1000:1000::/home/ann:/bin/sh\n";
        let redaction = Redaction::new(passwd);
        assert_eq!(
            redaction.apply(
                "ann: root=UUID=6f1d1b7a-0c1e-4b1e-9d6e-0123456789ab dev 00:1b:21:0A:bc:de serial=X12, annual /home/ann é"
            ),
            "(user): root=UUID=(uuid) dev (hardware address) serial=(serial), annual /home/(user) é"
        );
    }
}
