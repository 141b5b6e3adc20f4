//! What can go wrong between the robot's datagrams and the core.

use franka_proto::DecodeError;

use crate::exchange::SendError;
use crate::sys;

/// A datagram, a receive or a send that failed. The loop goes on: the next state may be a good one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkFault {
    /// A datagram of the robot is no state. Too short a one usually means a server of another
    /// version.
    #[error(transparent)]
    Datagram(#[from] DecodeError),
    /// A state was dropped: its number is further above the newest one's than any robot's could be
    /// (see [`LEAP_MAX`](crate::exchange::LEAP_MAX)).
    #[error("a robot state numbered {got} after one numbered {newest} was dropped")]
    Leap {
        /// `message_id` of the state, `[ms]`.
        got: u64,
        /// `message_id` of the newest state, `[ms]`.
        newest: u64,
    },
    /// A receive failed otherwise than by finding nothing; an errno value.
    #[error("libfranka: UDP receive: {}", sys::error_text(*.0))]
    Receive(i32),
    /// A command did not leave.
    #[error(transparent)]
    Send(#[from] SendError),
}

/// Lets the first of several equal faults in a row through, so that one that lasts is told once and
/// not every cycle.
#[derive(Debug, Default)]
pub(super) struct Latch(Option<LinkFault>);

impl Latch {
    /// Takes what happened (`None`: all went well) and returns it if it is not the same as the time
    /// before.
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
