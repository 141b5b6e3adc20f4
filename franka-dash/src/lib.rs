//! A page in the browser that shows a robot, and lets one person at a time move it.
//!
//! ```text
//!  Robot or Running ──states──> hub ──newest frame, events──> viewer ──WebSocket──> page
//!        ^                       |                               |
//!        └── sessions, stop ─────┴──── authority <───requests────┘
//! ```
//!
//! | module | content |
//! |---|---|
//! | `admission` | the checks in front of the files of a page, and of everything else |
//! | `any_messages` | what has to hold whatever viewers send, for tests |
//! | `authority` | lease, hold and deadman: a state machine without clock and sockets |
//! | `contact` | where something touches the arm, estimated |
//! | `describe` | what a page is told first |
//! | `fingers` | the gripper |
//! | `frame` | the binary state frame |
//! | `hold` | the motion of one hold |
//! | `hub` | what all viewers share |
//! | `news` | events as lines for people |
//! | `options` | who may see and do what |
//! | `pace` | how fast the arm may go, so that none of its points exceeds a speed |
//! | `page` | the files of the page |
//! | `plan` | what a motion with a target does, before it does it |
//! | `recording` | recordings, in a folder of the server |
//! | `reply` | what viewers are told, JSON |
//! | `request` | what viewers ask for, JSON |
//! | `several` | several robots on one server |
//! | `simulated` | what is done to a simulated robot |
//! | `source` | where states come from |
//! | `statistics` | how punctual control is |
//! | `viewer` | one viewer's socket |
//! | `way` | where a motion goes, how fast and how stiff |
//!
//! # Example
//!
//! ```no_run
//! use franka_async::Robot;
//! use franka_dash::Options;
//!
//! # async fn run() -> Result<(), Box<dyn std::error::Error>> {
//! let robot = Robot::connect("172.16.0.2").await?;
//! let options = Options::default(); // view-only, for this computer
//! let listener = franka_dash::bind("127.0.0.1:8080".parse()?, &options).await?;
//! let page = franka_dash::router(robot, options);
//! # Ok(())
//! # }
//! ```
//!
//! `axum::serve(listener, page.into_make_service_with_connect_info::<SocketAddr>())` then serves it;
//! any back end may nest the router instead, under a path that ends with a slash, and has to serve
//! it so as well: a server that does not know the addresses of its peers asks all of them for a
//! token. [`several`] serves more than one robot.
//!
//! # Moving the arm
//!
//! Only a server with [`Options::allow_motion`] moves anything. One viewer has the lease; it is
//! free again when released, when its socket closes, and after 5 s of silence. Motions go on only
//! while a button is held: the page then sends 20 messages per second, and the arm brakes when the
//! next one does not come within 150 ms. The control thread of the driver watches by itself, with
//! 200 ms. Any viewer can stop the arm.
//!
//! The budget of a joint motion keeps every point of the arm below the speed that was asked for,
//! 0.25 m/s at most. That of the end effector bounds the end effector; the control thread
//! ends the hold in the cycle in which a joint, the flange or the end effector is above 0.25 m/s.
//!
//! A browser is neither an enabling device nor an emergency stop.
//!
//! # What it does not do
//!
//! TLS: put a proxy in front where the network is not trusted.

mod admission;
#[cfg(test)]
mod any_messages;
mod authority;
mod contact;
mod describe;
mod fingers;
mod frame;
mod hold;
mod hub;
mod news;
mod options;
mod pace;
mod page;
mod plan;
mod recording;
mod reply;
mod request;
mod several;
mod simulated;
mod source;
mod statistics;
mod viewer;
mod way;

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use axum::Router;
use axum::extract::{State, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use franka_async::Robot;
use franka_async::connection::admission::{Admission, NoToken};
use franka_sim::{Running, Stopped};
use tokio::net::{TcpListener, TcpSocket};

use hub::Hub;
pub use options::Options;
pub use several::{NameError, several};
use source::{Source, Watched};

// The program in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Why a server cannot listen.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BindError {
    /// Other computers could connect, and nothing keeps them out.
    #[error(transparent)]
    NoToken(#[from] NoToken),
    /// The operating system refuses.
    #[error("listening on {address}")]
    Io {
        /// Where it was to listen.
        address: SocketAddr,
        /// Why.
        source: io::Error,
    },
}

/// Listens for viewers: on a loopback address, or with a token anywhere. Connections have
/// `TCP_NODELAY`; a back end that listens by itself should set it, since without it a frame waits
/// up to 40 ms behind every message that the page does not answer.
///
/// # Errors
/// [`BindError`].
///
/// # Cancel safety
/// Dropping the future leaves nothing behind.
pub async fn bind(address: SocketAddr, options: &Options) -> Result<TcpListener, BindError> {
    options.admission.check_listener(address)?;
    listen(address).map_err(|source| BindError::Io { address, source })
}

fn listen(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = match address {
        SocketAddr::V4(_) => TcpSocket::new_v4()?,
        SocketAddr::V6(_) => TcpSocket::new_v6()?,
    };
    // As `TcpListener::bind` does. Elsewhere it means that others may listen there, too.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    // The connections that it accepts have it, too.
    socket.set_nodelay(true)?;
    socket.bind(address)?;
    socket.listen(WAITING)
}

/// The page and its socket (`/ws`) for a connected robot. Must be called within a Tokio runtime.
/// The router keeps a handle of the robot.
pub fn router(robot: Robot, options: Options) -> Router {
    let admission = options.admission.clone();
    serve(Hub::start(Source::Robot(robot), options), admission)
}

/// The page for a simulated robot that another program controls: it is shown and can be disturbed.
/// To move it from the page, connect to it and use [`router`] with [`Options::simulated`].
///
/// # Errors
/// [`Stopped`] if the simulation has ended.
///
/// # Cancel safety
/// Dropping the future leaves nothing behind.
pub async fn simulator(running: &Arc<Running>, options: Options) -> Result<Router, Stopped> {
    let newest = |robot: &mut franka_sim::Robot| (robot.config().kind, *robot.state());
    let (kind, state) = running.with(newest).await?;
    let watched = Source::Watched(Box::new(Watched::new(kind, state)));
    let admission = options.admission.clone();
    let hub = Hub::start(watched, options.simulated(running));
    Ok(serve(hub, admission))
}

fn serve(hub: Arc<Hub>, admission: Admission) -> Router {
    let admissions: Arc<[Admission]> = [admission].into();
    Router::new()
        .route("/ws", get(connect))
        // A page is not told why its socket was refused: it asks here.
        .route("/access", get(async || StatusCode::NO_CONTENT))
        .layer(from_fn_with_state(admissions.clone(), admission::rest))
        .merge(page::routes().layer(from_fn_with_state(admissions, admission::files)))
        .with_state(hub)
}

async fn connect(State(hub): State<Arc<Hub>>, upgrade: WebSocketUpgrade) -> Response {
    let Ok(seat) = hub.seats.clone().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many viewers").into_response();
    };
    upgrade
        .protocols([PROTOCOL])
        .max_message_size(MESSAGE_MAX)
        .max_frame_size(MESSAGE_MAX)
        .read_buffer_size(MESSAGE_MAX)
        .write_buffer_size(0)
        .max_write_buffer_size(WRITE_MAX)
        .on_upgrade(async move |socket| {
            viewer::attend(hub, socket).await;
            drop(seat);
        })
}

/// The subprotocol of the socket.
const PROTOCOL: &str = "franka-dash";

/// Connections that may wait to be accepted.
const WAITING: u32 = 1024;

/// Bytes of a request.
const MESSAGE_MAX: usize = 4096;

/// Bytes that wait for one viewer's socket.
const WRITE_MAX: usize = 64 * 1024;
