//! Access to a JSON document that names the place of whatever is not as expected.

use serde_json::Value;

/// A value inside a document of vectors, and the path that leads to it.
#[derive(Clone, Debug)]
pub struct Node<'a> {
    value: &'a Value,
    path: String,
}

/// A document that does not have the shape that its suite reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: expected {expected}, found {found}")]
pub struct Malformed {
    /// Where in the document, for example `samples[3].q`.
    pub path: String,
    /// What the suite expects there.
    pub expected: String,
    /// What the document holds there.
    pub found: String,
}

impl<'a> Node<'a> {
    /// The whole document.
    pub fn root(value: &'a Value) -> Self {
        Self {
            value,
            path: String::new(),
        }
    }

    /// Where this value stands in its document, for example `samples[3].q`; `document` for the
    /// root.
    pub fn path(&self) -> &str {
        if self.path.is_empty() {
            "document"
        } else {
            &self.path
        }
    }

    /// The value itself, for what the other methods do not cover.
    pub fn value(&self) -> &'a Value {
        self.value
    }

    /// The member `name` of an object.
    ///
    /// # Errors
    /// If this is not an object or has no such member.
    pub fn get(&self, name: &str) -> Result<Node<'a>, Malformed> {
        self.find(name)
            .ok_or_else(|| self.malformed(format!("an object with `{name}`")))
    }

    /// The member `name` of an object, if there is one.
    pub fn find(&self, name: &str) -> Option<Node<'a>> {
        let path = match self.path.as_str() {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        self.value.get(name).map(|value| Node { value, path })
    }

    /// The members of an object with their names, in the order of the names.
    ///
    /// # Errors
    /// If this is not an object.
    pub fn members(&self) -> Result<Vec<(&'a str, Node<'a>)>, Malformed> {
        let object = self
            .value
            .as_object()
            .ok_or_else(|| self.malformed("an object"))?;
        let names = object.keys().map(String::as_str);
        Ok(names
            .filter_map(|name| Some((name, self.find(name)?)))
            .collect())
    }

    /// The elements of an array.
    ///
    /// # Errors
    /// If this is not an array.
    pub fn list(&self) -> Result<Vec<Node<'a>>, Malformed> {
        let elements = self
            .value
            .as_array()
            .ok_or_else(|| self.malformed("an array"))?;
        let nodes = elements.iter().enumerate().map(|(index, value)| Node {
            value,
            path: format!("{}[{index}]", self.path),
        });
        Ok(nodes.collect())
    }

    /// A number.
    ///
    /// # Errors
    /// If this is anything else.
    pub fn number(&self) -> Result<f64, Malformed> {
        self.value
            .as_f64()
            .ok_or_else(|| self.malformed("a number"))
    }

    /// An integer from 0 to 2^64 - 1; `true` and `false` count as 1 and 0, as in the wire vectors.
    ///
    /// # Errors
    /// If this is anything else.
    pub fn integer(&self) -> Result<u64, Malformed> {
        let integer = self
            .value
            .as_u64()
            .or_else(|| self.value.as_bool().map(u64::from));
        integer.ok_or_else(|| self.malformed("an integer that is not negative"))
    }

    /// A boolean; the integers 1 and 0 count as `true` and `false`, as in the wire vectors.
    ///
    /// # Errors
    /// If this is anything else.
    pub fn boolean(&self) -> Result<bool, Malformed> {
        match (self.value.as_bool(), self.value.as_u64()) {
            (Some(boolean), _) => Ok(boolean),
            (None, Some(integer @ 0..=1)) => Ok(integer == 1),
            _ => Err(self.malformed("a boolean")),
        }
    }

    /// A text.
    ///
    /// # Errors
    /// If this is anything else.
    pub fn text(&self) -> Result<&'a str, Malformed> {
        self.value.as_str().ok_or_else(|| self.malformed("a text"))
    }

    /// An array of any number of numbers.
    ///
    /// # Errors
    /// If this is not an array or an element is not a number.
    pub fn vector(&self) -> Result<Vec<f64>, Malformed> {
        self.list()?.iter().map(Node::number).collect()
    }

    /// An array of exactly `N` numbers.
    ///
    /// # Errors
    /// If this is not an array, is longer or shorter, or an element is not a number.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N], Malformed> {
        self.vector()?
            .try_into()
            .map_err(|_| self.malformed(format!("{N} numbers")))
    }

    /// Bytes, written as a text of two hexadecimal digits each.
    ///
    /// # Errors
    /// If this is not such a text.
    pub fn bytes(&self) -> Result<Vec<u8>, Malformed> {
        let text = self.text()?.as_bytes();
        let (pairs, rest) = text.as_chunks::<2>();
        let bytes = pairs.iter().map(|&[high, low]| {
            let digit = |character| (character as char).to_digit(16);
            u8::try_from(digit(high)? * 16 + digit(low)?).ok()
        });
        let bytes: Option<Vec<u8>> = bytes.collect();
        bytes
            .filter(|_| rest.is_empty())
            .ok_or_else(|| self.malformed("pairs of hexadecimal digits"))
    }

    /// The fault that something at this place is not as `expected`.
    pub fn malformed(&self, expected: impl Into<String>) -> Malformed {
        let mut found = self.value.to_string();
        if found.len() > FOUND_MAX {
            let end = (0..=FOUND_MAX)
                .rev()
                .find(|&end| found.is_char_boundary(end));
            found.truncate(end.unwrap_or(0));
            found.push_str("...");
        }
        Malformed {
            path: self.path().to_owned(),
            expected: expected.into(),
            found,
        }
    }
}

/// Bytes of a value that an error quotes: enough to recognise it, short enough for one line.
const FOUND_MAX: usize = 60;

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_fault_names_its_place_and_what_stands_there() {
        let value = json!({ "samples": [{ "q": [1.0, 2.0] }, { "q": [1.0, "two"] }] });
        let samples = Node::root(&value).get("samples").unwrap().list().unwrap();
        assert_eq!(
            samples[0].get("q").unwrap().numbers::<2>().unwrap(),
            [1.0, 2.0]
        );
        let text = |result: Result<[f64; 3], Malformed>| result.unwrap_err().to_string();
        assert_eq!(
            text(samples[0].get("q").unwrap().numbers()),
            "samples[0].q: expected 3 numbers, found [1.0,2.0]"
        );
        assert_eq!(
            text(samples[1].get("q").unwrap().numbers()),
            "samples[1].q[1]: expected a number, found \"two\""
        );
        let missing = Node::root(&value).get("sample").unwrap_err();
        assert!(
            missing
                .to_string()
                .starts_with("document: expected an object with `sample`")
        );
    }

    #[test]
    fn bytes_are_whole_pairs_of_digits() {
        let value = json!(["00ff1A", "0", "zz", 7]);
        let list = Node::root(&value).list().unwrap();
        assert_eq!(list[0].bytes().unwrap(), [0x00, 0xff, 0x1a]);
        assert!(list[1..].iter().all(|node| node.bytes().is_err()));
    }

    #[test]
    fn numbers_are_read_to_the_last_bit() {
        // Without serde_json's `float_roundtrip` the last digit of some numbers is off by one.
        let text = "[0.30000000000000004, 2.2250738585072014e-308, 122.416294033786585]";
        let value: Value = serde_json::from_str(text).unwrap();
        assert_eq!(
            Node::root(&value).numbers::<3>().unwrap(),
            [
                0.300_000_000_000_000_04,
                2.225_073_858_507_201_4e-308,
                122.416_294_033_786_58
            ]
        );
    }
}
