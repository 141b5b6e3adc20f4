//! Token of a service.

use std::env::{self, VarError};
use std::fmt::{self, Write as _};
use std::path::{Path, PathBuf};
use std::{fs, io};

use subtle::ConstantTimeEq as _;

/// Secret that admits other computers to a service. `Debug` does not show it.
#[derive(Clone)]
pub struct Token(String);

/// Reason why a text or a source cannot be a token.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TokenError {
    /// The text is empty.
    #[error("the token is empty, expected {TOKEN_MIN} characters or more")]
    Empty,
    /// The text is so short that it can be guessed.
    #[error("the token has {got} characters, expected {TOKEN_MIN} or more")]
    Short {
        /// Number of characters of the text.
        got: usize,
    },
    /// The text contains a character that addresses and headers do not transmit unchanged.
    #[error("the token contains the character {got:?}, expected letters, digits and - _ . ~")]
    Character {
        /// The first such character of the text.
        got: char,
    },
    /// The file cannot be read.
    #[error("cannot read the token in {}", path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The environment variable is not UTF-8.
    #[error("the environment variable {TOKEN_VARIABLE} is not UTF-8 text")]
    Variable,
    /// The operating system provides no random numbers.
    #[error("cannot get random numbers for a token")]
    Random {
        /// Error of the operating system.
        source: io::Error,
    },
}

impl Token {
    /// Makes a token from at least 16 letters, digits, `-`, `_`, `.` and `~`. The characters should
    /// be random.
    ///
    /// # Errors
    /// Returns [`TokenError::Empty`], [`TokenError::Short`] or [`TokenError::Character`] if the
    /// text is not a valid token.
    pub fn new(text: impl Into<String>) -> Result<Self, TokenError> {
        let text = text.into();
        let is_odd = |c: &char| !(c.is_ascii_alphanumeric() || "-_.~".contains(*c));
        match (text.chars().find(is_odd), text.len()) {
            (_, 0) => Err(TokenError::Empty),
            (Some(got), _) => Err(TokenError::Character { got }),
            (None, got) if got < TOKEN_MIN => Err(TokenError::Short { got }),
            (None, _) => Ok(Self(text)),
        }
    }

    /// Makes a random token of 128 bits.
    ///
    /// # Errors
    /// Returns [`TokenError::Random`] if the operating system provides no random numbers.
    pub fn generate() -> Result<Self, TokenError> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|error| TokenError::Random {
            source: error.into(),
        })?;
        let mut text = String::new();
        for byte in bytes {
            write!(text, "{byte:02x}").expect("writing to a String does not fail");
        }
        Ok(Self(text))
    }

    /// Reads a token from a file, without the white space around it.
    ///
    /// # Errors
    /// Returns [`TokenError::File`] if the file cannot be read, and the errors of [`Self::new`].
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, TokenError> {
        let path = path.as_ref();
        let text = fs::read_to_string(path).map_err(|source| TokenError::File {
            path: path.to_owned(),
            source,
        })?;
        Self::new(text.trim())
    }

    /// Reads the token from `file`. If there is no `file`, reads it from the environment variable
    /// [`TOKEN_VARIABLE`]. Returns `None` if neither is set. Services should not take a token as an
    /// argument: every user of the computer can read the arguments of its programs.
    ///
    /// # Errors
    /// Returns the errors of [`Self::from_file`], and [`TokenError::Variable`] if the variable is
    /// not UTF-8. An empty variable is an error.
    pub fn configured(file: Option<&Path>) -> Result<Option<Self>, TokenError> {
        Self::given(file, env::var(TOKEN_VARIABLE))
    }

    fn given(
        file: Option<&Path>,
        variable: Result<String, VarError>,
    ) -> Result<Option<Self>, TokenError> {
        match (file, variable) {
            (Some(file), _) => Self::from_file(file).map(Some),
            (None, Ok(text)) => Self::new(text.trim()).map(Some),
            (None, Err(VarError::NotPresent)) => Ok(None),
            (None, Err(VarError::NotUnicode(_))) => Err(TokenError::Variable),
        }
    }

    /// Returns the text of the token, to show it to people who may move the arm.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// Compares the token with `offered`, in a time that depends only on their lengths.
    pub(super) fn is(&self, offered: &str) -> bool {
        self.0.as_bytes().ct_eq(offered.as_bytes()).into()
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(..)")
    }
}

/// Environment variable that [`Token::configured`] reads.
pub const TOKEN_VARIABLE: &str = "FRANKA_ACCESS_TOKEN";

/// Smallest number of characters: 16 random characters cannot be guessed over a network.
const TOKEN_MIN: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_long_and_of_plain_characters() {
        for (text, error) in [
            ("", "the token is empty, expected 16 characters or more"),
            (
                "fifteen-letters",
                "the token has 15 characters, expected 16 or more",
            ),
            (
                "comma,comma,comma",
                "the token contains the character ',', expected letters, digits and - _ . ~",
            ),
            (
                "  white    space  ",
                "the token contains the character ' ', expected letters, digits and - _ . ~",
            ),
        ] {
            let got = Token::new(text).expect_err(text).to_string();
            assert_eq!(got, error);
        }
        let token = Token::new("sixteen-letters.").expect("a token");
        assert!(token.is("sixteen-letters."));
        assert!(!token.is("sixteen-letters,") && !token.is("sixteen-letters") && !token.is(""));
        assert_eq!(format!("{token:?}"), "Token(..)");
    }

    #[test]
    fn generated_tokens_differ_and_are_tokens() {
        let [one, other] = [(); 2].map(|()| Token::generate().expect("random numbers"));
        assert!(!one.is(other.reveal()));
        assert!(Token::new(one.reveal()).is_ok());
    }

    #[test]
    fn token_file_precedes_variable_and_empty_one_is_an_error() {
        let file = std::env::temp_dir().join(format!("franka-token-{}", std::process::id()));
        fs::write(&file, "token-of-the-file\n").expect("a file");
        let variable = || Ok("  token-of-the-variable ".to_owned());
        let text = |given: Result<Option<Token>, TokenError>| {
            given.map(|token| token.map(|token| token.reveal().to_owned()))
        };
        let both = text(Token::given(Some(&file), variable()));
        assert_eq!(both.expect("a token").as_deref(), Some("token-of-the-file"));
        let one = text(Token::given(None, variable()));
        let wanted = Some("token-of-the-variable");
        assert_eq!(one.expect("a token").as_deref(), wanted);
        let none = Token::given(None, Err(VarError::NotPresent));
        assert!(none.expect("no error").is_none());
        let empty = Token::given(None, Ok(String::new()));
        assert!(matches!(empty, Err(TokenError::Empty)), "{empty:?}");
        fs::write(&file, "\n").expect("a file");
        let empty = Token::given(Some(&file), variable());
        assert!(matches!(empty, Err(TokenError::Empty)), "{empty:?}");
        fs::remove_file(&file).expect("it was there");
        let gone = Token::given(Some(&file), variable());
        assert!(matches!(gone, Err(TokenError::File { .. })), "{gone:?}");
        let odd = Token::given(None, Err(VarError::NotUnicode("x".into())));
        assert!(matches!(odd, Err(TokenError::Variable)), "{odd:?}");
    }
}
