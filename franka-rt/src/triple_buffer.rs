//! One writer, one reader, newest value only, for values of any type: how goals enter the thread.
//!
//! The buffers are those of the crate `triple_buffer`. The writer and the reader own one buffer
//! each, and exchange it with the third buffer in one atomic step. So neither side waits for the
//! other one, and the reader gets no mixture of two values. [`slot`](crate::slot) has many readers,
//! but only carries values that can be written as words.
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

/// Creates an empty buffer. This call allocates; neither end does afterwards.
pub fn triple_buffer<T: Copy + Send>() -> (Writer<T>, Reader<T>) {
    let (input, output) = ::triple_buffer::triple_buffer(&None);
    (Writer(input), Reader(output))
}

/// Writing end.
#[derive(Debug)]
pub struct Writer<T: Send>(Input<Option<T>>);

/// Reading end.
#[derive(Debug)]
pub struct Reader<T: Send>(Output<Option<T>>);

impl<T: Copy + Send> Writer<T> {
    /// Makes `value` the newest value. It replaces an earlier value that was not read.
    pub fn write(&mut self, value: T) {
        self.0.write(Some(value));
    }
}

impl<T: Copy + Send> Reader<T> {
    /// Takes the newest value, if it was not taken before.
    pub fn read_newer(&mut self) -> Option<T> {
        match self.0.update() {
            true => *self.0.output_buffer(),
            false => None,
        }
    }
}
