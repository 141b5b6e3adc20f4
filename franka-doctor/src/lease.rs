//! Detects whether an address of the host is leased, from the kernel's list of addresses.

use std::io::{self, Read as _};
use std::net::Ipv4Addr;
use std::time::Duration;

use socket2::{Domain, Protocol, Socket, Type};

/// Returns true if the host has `address` permanently, false if the address is leased, and `None`
/// if the host does not have it. The function requests all IPv4 addresses from the kernel
/// (`RTM_GETADDR`). The request changes nothing and needs no privileges.
pub(crate) fn is_lasting(address: Ipv4Addr) -> io::Result<Option<bool>> {
    let protocol = Protocol::from(libc::NETLINK_ROUTE);
    let socket = Socket::new(Domain::from(libc::AF_NETLINK), Type::RAW, Some(protocol))?;
    socket.set_read_timeout(Some(Duration::from_secs(1)))?;
    socket.send(&request())?;
    let mut part = vec![0; PART_MAX];
    // The loop is bounded, in case the kernel never reports the end.
    for _ in 0..PARTS_MAX {
        let length = (&socket).read(&mut part)?;
        match found(&part[..length], address) {
            Answer::Found(lasting) => return Ok(Some(lasting)),
            Answer::Done => return Ok(None),
            Answer::More => {}
            Answer::Refused => return Err(io::ErrorKind::Unsupported.into()),
        }
    }
    Err(io::ErrorKind::InvalidData.into())
}

/// Result of the search in a part of the kernel's answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// The part contains the address. The value is true if the address is permanent.
    Found(bool),
    /// This part is the last, and does not contain the address.
    Done,
    /// This part does not contain the address, and more parts follow.
    More,
    Refused,
}

/// Returns a `struct nlmsghdr` that requests all addresses, and an empty `struct ifaddrmsg`.
fn request() -> [u8; HEADER + MESSAGE] {
    let mut request = [0; HEADER + MESSAGE];
    request[0..4].copy_from_slice(&((HEADER + MESSAGE) as u32).to_ne_bytes());
    request[4..6].copy_from_slice(&libc::RTM_GETADDR.to_ne_bytes());
    let flags = (libc::NLM_F_REQUEST | libc::NLM_F_DUMP) as u16;
    request[6..8].copy_from_slice(&flags.to_ne_bytes());
    request[HEADER] = libc::AF_INET as u8;
    request
}

/// Searches for `address` in the messages of a part. An invalid message ends the search.
fn found(mut part: &[u8], address: Ipv4Addr) -> Answer {
    while let Some(header) = part.first_chunk::<HEADER>() {
        let length = u32::from_ne_bytes([header[0], header[1], header[2], header[3]]) as usize;
        let kind = i32::from(u16::from_ne_bytes([header[4], header[5]]));
        match kind {
            libc::NLMSG_DONE => return Answer::Done,
            libc::NLMSG_ERROR => return Answer::Refused,
            _ => {}
        }
        let Some(message) = part.get(HEADER..length) else {
            break;
        };
        if kind == i32::from(libc::RTM_NEWADDR)
            && let Some(lasting) = lasting(message, address)
        {
            return Answer::Found(lasting);
        }
        part = part.get(aligned(length)..).unwrap_or_default();
    }
    Answer::More
}

/// Returns true if the address is permanent, and `None` if this message describes another address.
/// A message is a `struct ifaddrmsg` followed by attributes.
fn lasting(message: &[u8], address: Ipv4Addr) -> Option<bool> {
    // The header contains only eight bits of the flags. An attribute contains all bits.
    let mut flags = u32::from(*message.get(2)?);
    let mut own = None;
    let mut rest = message.get(MESSAGE..)?;
    while let Some(&[a, b, c, d]) = rest.first_chunk::<ATTRIBUTE>() {
        let length = usize::from(u16::from_ne_bytes([a, b]));
        let kind = u16::from_ne_bytes([c, d]);
        let Some(&value) = rest
            .get(ATTRIBUTE..length)
            .and_then(|value| value.first_chunk::<4>())
        else {
            rest = rest
                .get(aligned(length).max(ATTRIBUTE)..)
                .unwrap_or_default();
            continue;
        };
        match kind {
            libc::IFA_LOCAL => own = Some(Ipv4Addr::from(value)),
            IFA_FLAGS => flags = u32::from_ne_bytes(value),
            _ => {}
        }
        rest = rest.get(aligned(length)..).unwrap_or_default();
    }
    (own == Some(address)).then_some(flags & libc::IFA_F_PERMANENT != 0)
}

/// Rounds up to a multiple of four bytes, at which messages and attributes begin.
fn aligned(length: usize) -> usize {
    length.next_multiple_of(4)
}

/// Size of `struct nlmsghdr`.
const HEADER: usize = 16;
/// Size of `struct ifaddrmsg`.
const MESSAGE: usize = 8;
/// Size of `struct rtattr`.
const ATTRIBUTE: usize = 4;
/// Attribute with the flags, from `linux/if_addr.h`.
const IFA_FLAGS: u16 = 8;
/// Largest part that the kernel sends, in bytes.
const PART_MAX: usize = 1 << 15;
/// Largest number of parts that are read. It is enough for some thousand addresses.
const PARTS_MAX: usize = 256;

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: Ipv4Addr = Ipv4Addr::new(172, 16, 0, 1);

    fn attribute(kind: u16, value: [u8; 4]) -> Vec<u8> {
        [&8_u16.to_ne_bytes()[..], &kind.to_ne_bytes(), &value].concat()
    }

    fn message(kind: u16, body: &[u8]) -> Vec<u8> {
        let length = (HEADER + body.len()) as u32;
        let mut message = [&length.to_ne_bytes()[..], &kind.to_ne_bytes(), &[0; 10]].concat();
        message.extend(body);
        message
    }

    /// Returns the kernel's message for an address with these flags.
    fn address(own: Ipv4Addr, flags: u32) -> Vec<u8> {
        let body = [
            vec![2, 24, 0, 0, 3, 0, 0, 0],
            attribute(libc::IFA_LOCAL, own.octets()),
            // The length of this name is not a multiple of four bytes.
            [&7_u16.to_ne_bytes()[..], &3_u16.to_ne_bytes(), b"lo\0\0"].concat(),
            attribute(IFA_FLAGS, flags.to_ne_bytes()),
        ];
        message(libc::RTM_NEWADDR, &body.concat())
    }

    #[test]
    fn the_flag_of_the_own_address_decides() {
        let other = address(Ipv4Addr::new(10, 0, 0, 1), 0);
        for (flags, expected) in [(libc::IFA_F_PERMANENT, true), (0x200, false)] {
            let part = [other.clone(), address(OWN, flags)].concat();
            assert_eq!(found(&part, OWN), Answer::Found(expected));
        }
        assert_eq!(found(&other, OWN), Answer::More);
        let done = message(libc::NLMSG_DONE as u16, &[0; 4]);
        assert_eq!(found(&[other, done].concat(), OWN), Answer::Done);
        let error = message(libc::NLMSG_ERROR as u16, &[0; 4]);
        assert_eq!(found(&error, OWN), Answer::Refused);
    }

    #[test]
    fn bytes_that_are_cut_off_anywhere_are_no_answer() {
        let whole = address(OWN, libc::IFA_F_PERMANENT);
        for end in 0..whole.len() {
            let answer = found(&whole[..end], OWN);
            assert_eq!(answer, Answer::More, "{end}");
        }
        // The length is zero, with which the search would never advance.
        assert_eq!(found(&[0; 64], OWN), Answer::More);
    }

    #[test]
    fn this_host_has_its_own_address_for_good() {
        assert_eq!(is_lasting(Ipv4Addr::LOCALHOST).ok(), Some(Some(true)));
        let documentation = Ipv4Addr::new(192, 0, 2, 1);
        assert_eq!(is_lasting(documentation).ok(), Some(None));
    }
}
