//! A viewer that never reads does not increase the server's memory, and does not affect other
//! viewers. An allocator counts the memory in use, so this is the only test of its program.

#[path = "../sockets/viewer.rs"]
#[allow(dead_code, reason = "other programs use the rest")]
mod viewer;

use std::alloc::{GlobalAlloc, Layout, System};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use socket2::{Domain, Socket, Type};
use tungstenite::Message;
use tungstenite::client::IntoClientRequest as _;

use viewer::{LONGEST, Served, Viewer};

/// Bytes in use, and the largest value since it was reset.
static IN_USE: AtomicI64 = AtomicI64::new(0);
static MOST: AtomicI64 = AtomicI64::new(0);

struct Counting;

fn count(bytes: i64) {
    let now = IN_USE.fetch_add(bytes, Ordering::Relaxed) + bytes;
    MOST.fetch_max(now, Ordering::Relaxed);
}

// SAFETY: every method passes its arguments to the system's allocator unchanged and returns its
// result; counting changes atomics, which neither allocates nor fails.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller's obligations are the same as for the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        // SAFETY: as above; `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Returns a connection with little space for unread data.
fn deaf(address: SocketAddr) -> tungstenite::WebSocket<std::net::TcpStream> {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None).expect("a socket");
    socket.set_recv_buffer_size(4096).expect("an option");
    socket.connect(&address.into()).expect("a connection");
    let request = format!("ws://{address}/ws");
    let request = request.into_client_request().expect("a request");
    let (socket, _) = tungstenite::client(request, socket.into()).expect("a socket");
    socket
}

/// Sends requests with long refusals, and reads no answers, until the server disconnects. Returns
/// the approximate number of bytes of the answers.
fn flood(address: SocketAddr) -> usize {
    let mut socket = deaf(address);
    let begin = Instant::now();
    // The answer repeats the request.
    let request = format!(r#"{{"type":"{}"}}"#, "x".repeat(4000));
    let mut sent = 0;
    while socket.send(Message::text(request.as_str())).is_ok() {
        sent += request.len();
        assert!(begin.elapsed() < LONGEST, "the server goes on with it");
    }
    sent
}

#[test]
fn viewer_that_never_reads_costs_no_memory_or_delay() {
    let served = Served::movable();
    let frames: [AtomicU64; OTHERS] = Default::default();
    let end = AtomicBool::new(false);
    let more = |begin: Instant| {
        let before = frames.each_ref().map(|it| it.load(Ordering::Relaxed));
        let each = || frames.iter().zip(before);
        while !each().all(|(now, before)| now.load(Ordering::Relaxed) >= before + 60) {
            assert!(begin.elapsed() < LONGEST, "a viewer gets no frames");
            thread::sleep(Duration::from_millis(10));
        }
    };
    thread::scope(|scope| {
        for count in &frames {
            let (end, address) = (&end, served.address);
            scope.spawn(move || {
                let mut viewer = Viewer::connect(address);
                while !end.load(Ordering::Relaxed) {
                    viewer.wait_for("frame");
                    count.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
        more(Instant::now());
        // A viewer that also sends nothing, and stays until it is disconnected.
        let silent = deaf(served.address);
        let before = IN_USE.load(Ordering::Relaxed);
        MOST.store(before, Ordering::Relaxed);
        let asked: usize = (0..FLOODS).map(|_| flood(served.address)).sum();
        more(Instant::now());
        let grown = MOST.load(Ordering::Relaxed) - before;
        println!("{asked} bytes were to be answered; {grown} bytes more in use at most");
        end.store(true, Ordering::Relaxed);
        drop(silent);
        assert!(grown < GROWTH_MAX, "{grown} bytes");
    });
}

/// Number of viewers that read.
const OTHERS: usize = 10;

/// Number of connections that do not read.
const FLOODS: usize = 3;

/// Largest increase of memory in use: waiting replies and frames, the buffers of the flooding
/// connection on both sides, and temporary memory of the robot's and viewers' threads.
const GROWTH_MAX: i64 = 1024 * 1024;
