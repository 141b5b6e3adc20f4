//! The packets of a capture, with their times and addresses.

use std::io::Cursor;
use std::net::{IpAddr, SocketAddr};

use etherparse::defrag::IpDefragPool;
use etherparse::{
    IpNumber, LaxNetSlice, LaxSlicedPacket, NetSlice, SlicedPacket, TransportSlice, UdpSlice,
};
use pcap_parser::traits::{PcapNGPacketBlock as _, PcapReaderIterator};
use pcap_parser::{Block, Linktype, PcapBlockOwned, PcapError, create_reader};

use super::CaptureError;

/// Iterator over the packets of a file, in order. Packets that are neither TCP nor UDP are
/// [`Body::Other`].
pub(super) struct Packets<'a> {
    reader: Box<dyn PcapReaderIterator + 'a>,
    interfaces: Vec<Interface>,
    fragments: IpDefragPool<(), ()>,
    truncated: u64,
    damage: Option<String>,
}

#[derive(Clone, Copy)]
struct Interface {
    link: Linktype,
    /// Number of time units per second. `offset` is the number of seconds to add.
    resolution: u64,
    offset: i64,
}

pub(super) struct Packet {
    /// Time in nanoseconds since the Unix epoch.
    pub(super) time: u64,
    pub(super) body: Body,
}

pub(super) enum Body {
    Tcp(Segment),
    Udp {
        from: SocketAddr,
        to: SocketAddr,
        payload: Vec<u8>,
    },
    /// A datagram that was captured only in part, for example because of a snap length.
    Cut {
        from: SocketAddr,
        to: SocketAddr,
    },
    Other,
}

pub(super) struct Segment {
    pub(super) from: SocketAddr,
    pub(super) to: SocketAddr,
    pub(super) sequence: u32,
    pub(super) opens: bool,
    pub(super) ends: bool,
    pub(super) resets: bool,
    pub(super) payload: Vec<u8>,
}

impl<'a> Packets<'a> {
    pub(super) fn new(file: &'a [u8]) -> Result<Self, CaptureError> {
        let capacity = file.len().clamp(BUFFER_MIN, BUFFER_MAX);
        let reader = create_reader(capacity, Cursor::new(file));
        let reader = reader.map_err(|error| CaptureError::Format {
            what: match compression(file) {
                Some(name) => format!("the file is compressed by {name}: decompress it first"),
                None => describe(&error),
            },
        })?;
        Ok(Self {
            reader,
            interfaces: Vec::new(),
            fragments: IpDefragPool::new(),
            truncated: 0,
            damage: None,
        })
    }

    /// Returns the number of packets so far that are shorter than their headers declare.
    pub(super) fn truncated(&self) -> u64 {
        self.truncated
    }

    /// Returns the reason why the file is truncated, if it is truncated.
    pub(super) fn damage(self) -> Option<String> {
        self.damage
    }

    pub(super) fn next(&mut self) -> Option<Packet> {
        loop {
            let exhausted = self.reader.reader_exhausted();
            match self.reader.next() {
                Ok((size, block)) => {
                    let packet = on_block(block, &mut self.interfaces, &mut self.fragments);
                    self.reader.consume(size);
                    if let Some((packet, truncated)) = packet {
                        self.truncated += u64::from(truncated);
                        return Some(packet);
                    }
                }
                Err(PcapError::Eof) => return None,
                Err(PcapError::Incomplete(_)) if !exhausted => {
                    let refilled = self.reader.refill().map_err(|error| describe(&error));
                    if let Err(what) = refilled {
                        self.damage = Some(what);
                        return None;
                    }
                }
                Err(error) => {
                    self.damage = Some(describe(&error));
                    return None;
                }
            }
        }
    }
}

/// Returns the packet in a block, and true if the packet was captured only in part.
fn on_block(
    block: PcapBlockOwned<'_>,
    interfaces: &mut Vec<Interface>,
    fragments: &mut IpDefragPool<(), ()>,
) -> Option<(Packet, bool)> {
    let (interface, ticks, data, short) = match &block {
        PcapBlockOwned::LegacyHeader(header) => {
            let nanoseconds = header.is_nanosecond_precision();
            interfaces.push(Interface {
                link: header.network,
                resolution: if nanoseconds {
                    1_000_000_000
                } else {
                    1_000_000
                },
                offset: 0,
            });
            return None;
        }
        PcapBlockOwned::Legacy(block) => {
            let interface = *interfaces.first()?;
            let seconds = u64::from(block.ts_sec) * interface.resolution;
            let short = block.caplen < block.origlen;
            let ticks = seconds + u64::from(block.ts_usec);
            (interface, ticks, block.data, short)
        }
        PcapBlockOwned::NG(Block::SectionHeader(_)) => {
            interfaces.clear();
            return None;
        }
        PcapBlockOwned::NG(Block::InterfaceDescription(block)) => {
            interfaces.push(Interface {
                link: block.linktype,
                resolution: block.ts_resolution().unwrap_or_default().max(1),
                offset: block.ts_offset(),
            });
            return None;
        }
        PcapBlockOwned::NG(Block::EnhancedPacket(block)) => {
            let interface = *interfaces.get(usize::try_from(block.if_id).ok()?)?;
            let ticks = u64::from(block.ts_high) << 32 | u64::from(block.ts_low);
            (interface, ticks, block.packet_data(), block.truncated())
        }
        // A simple packet has no time. Network captures do not contain such packets.
        PcapBlockOwned::NG(_) => return None,
    };
    let nanoseconds = i128::from(ticks) * 1_000_000_000 / i128::from(interface.resolution)
        + i128::from(interface.offset) * 1_000_000_000;
    let whole = body(interface.link, data, fragments);
    let truncated = short && whole.is_none();
    let cut = || truncated.then(|| cut(interface.link, data)).flatten();
    let packet = Packet {
        time: u64::try_from(nanoseconds).unwrap_or_default(),
        body: whole.or_else(cut).unwrap_or(Body::Other),
    };
    Some((packet, truncated))
}

/// Returns the addresses of a datagram that was captured only in part.
fn cut(link: Linktype, data: &[u8]) -> Option<Body> {
    let sliced = match link {
        Linktype::ETHERNET => LaxSlicedPacket::from_ethernet(data).ok()?,
        Linktype::LINUX_SLL => LaxSlicedPacket::from_ip(data.get(16..)?).ok()?,
        Linktype::LINUX_SLL2 => LaxSlicedPacket::from_ip(data.get(20..)?).ok()?,
        Linktype::NULL | Linktype::LOOP => LaxSlicedPacket::from_ip(data.get(4..)?).ok()?,
        _ => LaxSlicedPacket::from_ip(data).ok()?,
    };
    let (source, destination): (IpAddr, IpAddr) = match sliced.net.as_ref()? {
        LaxNetSlice::Ipv4(ip) => (
            ip.header().source_addr().into(),
            ip.header().destination_addr().into(),
        ),
        LaxNetSlice::Ipv6(ip) => (
            ip.header().source_addr().into(),
            ip.header().destination_addr().into(),
        ),
        LaxNetSlice::Arp(_) => return None,
    };
    match &sliced.transport {
        Some(TransportSlice::Udp(udp)) => Some(Body::Cut {
            from: (source, udp.source_port()).into(),
            to: (destination, udp.destination_port()).into(),
        }),
        _ => None,
    }
}

/// Returns the program that compressed a file, determined from the first bytes of the file.
/// Wireshark reads and writes compressed captures.
fn compression(file: &[u8]) -> Option<&'static str> {
    match file {
        [0x1f, 0x8b, ..] => Some("gzip"),
        [0x28, 0xb5, 0x2f, 0xfd, ..] => Some("zstd"),
        [0x04, 0x22, 0x4d, 0x18, ..] => Some("lz4"),
        _ => None,
    }
}

/// Returns the contents of a packet; `None` if they cannot be read.
fn body(link: Linktype, data: &[u8], fragments: &mut IpDefragPool<(), ()>) -> Option<Body> {
    let sliced = match link {
        Linktype::ETHERNET => SlicedPacket::from_ethernet(data),
        Linktype::LINUX_SLL => SlicedPacket::from_linux_sll(data),
        // A header of 20 or 4 bytes precedes the IP packet. `from_ip` refuses all other data.
        Linktype::LINUX_SLL2 => SlicedPacket::from_ip(data.get(20..)?),
        Linktype::NULL | Linktype::LOOP => SlicedPacket::from_ip(data.get(4..)?),
        _ => SlicedPacket::from_ip(data),
    };
    let sliced = sliced.ok()?;
    let (source, destination): (IpAddr, IpAddr) = match sliced.net.as_ref()? {
        NetSlice::Ipv4(ip) => (
            ip.header().source_addr().into(),
            ip.header().destination_addr().into(),
        ),
        NetSlice::Ipv6(ip) => (
            ip.header().source_addr().into(),
            ip.header().destination_addr().into(),
        ),
        NetSlice::Arp(_) => return None,
    };
    let datagram = |udp: &UdpSlice<'_>| Body::Udp {
        from: (source, udp.source_port()).into(),
        to: (destination, udp.destination_port()).into(),
        payload: udp.payload().to_vec(),
    };
    match &sliced.transport {
        Some(TransportSlice::Tcp(tcp)) => Some(Body::Tcp(Segment {
            from: (source, tcp.source_port()).into(),
            to: (destination, tcp.destination_port()).into(),
            sequence: tcp.sequence_number(),
            opens: tcp.syn(),
            ends: tcp.fin(),
            resets: tcp.rst(),
            payload: tcp.payload().to_vec(),
        })),
        Some(TransportSlice::Udp(udp)) => Some(datagram(udp)),
        _ => {
            let whole = fragments.process_sliced_packet(&sliced, (), ()).ok()??;
            let udp = (whole.ip_number == IpNumber::UDP)
                .then(|| UdpSlice::from_slice(&whole.payload).ok())
                .flatten();
            let body = udp.as_ref().map(datagram);
            fragments.return_buf(whole);
            body
        }
    }
}

fn describe(error: &PcapError<&[u8]>) -> String {
    match error {
        PcapError::Incomplete(_) | PcapError::UnexpectedEof | PcapError::Eof => {
            "the file ends in the middle of a record".to_owned()
        }
        PcapError::HeaderNotRecognized => "the file begins like neither format".to_owned(),
        error => format!("{error:?}").chars().take(ERROR_LENGTH).collect(),
    }
}

/// Smallest and largest size of the reader's buffer. The lower bound is larger than any header, and
/// the upper bound is larger than any record.
const BUFFER_MIN: usize = 64;
const BUFFER_MAX: usize = 1 << 20;

/// Largest length of a parser's error text, which can contain the unreadable data.
const ERROR_LENGTH: usize = 100;
