//! Buffer with one writer and one reader that passes only the newest value, of any type. Goals
//! enter the thread through it.
//!
//! The buffers come from the crate `triple_buffer`. The writer and the reader each own one buffer,
//! and exchange it with the third buffer in one atomic step. So neither side waits for the other,
//! and the reader never gets a mixture of two values. [`slot`](crate::slot) supports many readers,
//! but only values that can be stored as words.
//!
//! ```
//! let (mut writer, mut reader) = franka_rt::triple_buffer::triple_buffer();
//! assert_eq!(reader.read_newer(), None);
//! writer.write("first");
//! writer.write("second");
//! assert_eq!(reader.read_newer(), Some("second"));
//! assert_eq!(reader.read_newer(), None);
//! ```

use ::triple_buffer::{Input, Output};

/// Returns an empty buffer. This function allocates; neither end does afterwards.
pub fn triple_buffer<T: Copy + Send>() -> (Writer<T>, Reader<T>) {
    let (input, output) = ::triple_buffer::triple_buffer(&None);
    (Writer(input), Reader(output))
}

/// Writing end of a buffer.
#[derive(Debug)]
pub struct Writer<T: Send>(Input<Option<T>>);

/// Reading end of a buffer.
#[derive(Debug)]
pub struct Reader<T: Send>(Output<Option<T>>);

impl<T: Copy + Send> Writer<T> {
    /// Makes `value` the newest value. Replaces an earlier value even if it was not read.
    pub fn write(&mut self, value: T) {
        self.0.write(Some(value));
    }
}

impl<T: Copy + Send> Reader<T> {
    /// Returns the newest value if this reader has not returned it yet.
    pub fn read_newer(&mut self) -> Option<T> {
        match self.0.update() {
            true => *self.0.output_buffer(),
            false => None,
        }
    }
}
