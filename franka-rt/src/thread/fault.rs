//! Faults of the link: bad datagrams, and failed receives and sends.

use franka_proto::DecodeError;

use crate::exchange::SendError;
use crate::sys;

/// Fault of a datagram, a receive or a send. The loop continues, because the next state may be
/// good.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkFault {
    /// A datagram from the robot cannot be decoded. If it is too short, the server usually has
    /// another version.
    #[error(transparent)]
    Datagram(#[from] DecodeError),
    /// A state was dropped because its number is too far ahead of the newest number to come from a
    /// robot (see [`LEAP_MAX`](crate::exchange::LEAP_MAX)).
    #[error(
        "dropped the robot state with the number {got}, expected a number close to the newest, {newest}"
    )]
    Leap {
        /// `message_id` of the state, `[ms]`.
        got: u64,
        /// `message_id` of the newest state, `[ms]`.
        newest: u64,
    },
    /// A receive failed with this errno value.
    #[error("libfranka: UDP receive: {}", sys::error_text(*.0))]
    Receive(i32),
    /// A command could not be sent.
    #[error(transparent)]
    Send(#[from] SendError),
}

/// Passes on only the first of several equal faults in a row, so that a lasting fault is reported
/// once.
#[derive(Debug, Default)]
pub(super) struct Latch(Option<LinkFault>);

impl Latch {
    /// Returns the fault of a cycle if it differs from the fault of the previous cycle.
    pub(super) fn pass(&mut self, fault: Option<LinkFault>) -> Option<LinkFault> {
        let news = if self.0 == fault { None } else { fault };
        self.0 = fault;
        news
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lasting_fault_passes_once_and_again_after_a_good_cycle() {
        let short = Some(LinkFault::Datagram(DecodeError::DatagramSize {
            got: 1,
            expected: 2,
        }));
        let refused = Some(LinkFault::Receive(libc::ENOMEM));
        let mut latch = Latch::default();
        let passed =
            [None, short, short, refused, short, None, short].map(|fault| latch.pass(fault));
        assert_eq!(passed, [None, short, None, refused, short, None, short]);
    }

    #[test]
    fn the_texts_are_those_of_libfranka() {
        let texts = [
            LinkFault::Datagram(DecodeError::DatagramSize {
                got: 1376,
                expected: 1377,
            }),
            LinkFault::Receive(libc::ENOMEM),
            LinkFault::Send(SendError::Short {
                sent: 1,
                length: 371,
            }),
            LinkFault::Send(SendError::Refused(libc::ENETUNREACH)),
        ]
        .map(|fault| fault.to_string());
        assert_eq!(
            texts,
            [
                "libfranka: incorrect object size",
                "libfranka: UDP receive: Cannot allocate memory",
                "libfranka: could not send UDP data",
                "libfranka: UDP send: Network is unreachable",
            ]
        );
    }
}
