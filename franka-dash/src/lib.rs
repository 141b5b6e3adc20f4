//! A browser page that shows a robot and lets one person at a time move it.
//!
//! ```text
//!  Robot or Running ──states──> hub ──newest frame, events──> viewer ──WebSocket──> page
//!        ^                       |                               |
//!        └── sessions, stop ─────┴── viewer_lease <─requests─────┘
//! ```
//!
//! | module | content |
//! |---|---|
//! | `admission` | the checks of requests for the files of a page, and of all other requests |
//! | `any_messages` | properties that hold for any viewer messages, for tests |
//! | `viewer_lease` | lease, hold and deadman: a state machine without clock and sockets |
//! | `contact` | the estimated place of a contact on the arm |
//! | `describe` | the first message to a page |
//! | `fingers` | the gripper |
//! | `frame` | the binary state frame |
//! | `hold` | the motion of one hold |
//! | `hub` | the shared state of all viewers |
//! | `news` | events as lines for people |
//! | `options` | permissions |
//! | `pace` | speeds of the arm such that none of its points exceeds a limit |
//! | `page` | the files of the page |
//! | `plan` | the preview of a motion with a target |
//! | `recording` | recordings, in a folder of the server |
//! | `reply` | messages to viewers, JSON |
//! | `request` | requests of viewers, JSON |
//! | `several` | several robots on one server |
//! | `simulated` | disturbances of a simulated robot |
//! | `source` | the source of states |
//! | `statistics` | the punctuality of control |
//! | `viewer` | one viewer's socket |
//! | `way` | path, speed and stiffness of a motion |
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
//! `axum::serve(listener, page.into_make_service_with_connect_info::<SocketAddr>())` then serves
//! the page. Any other back end can nest the router under a path that ends with a slash. That back
//! end must also provide the peer addresses through `connect_info`. Without these addresses, the
//! server requires a token from every peer. [`several`] serves more than one robot.
//!
//! # Moving the arm
//!
//! An arm moves only if the server has [`Options::allow_motion`]. One viewer has the lease, the
//! exclusive right to move the arm. The lease becomes free when the viewer releases it, when the
//! viewer's socket closes, or after 5 s of silence. A motion continues only while its button is
//! held. Meanwhile the page sends 20 messages per second, and the arm brakes if no message arrives
//! for 150 ms. The driver's control thread has a separate deadman of 200 ms. Any viewer can stop
//! the arm.
//!
//! In a joint motion, every point of the arm stays below the requested speed, which is 0.25 m/s at
//! most. In an end-effector motion, this speed limits only the end effector. The control thread
//! ends the hold in the cycle in which a joint, the flange or the end effector exceeds 0.25 m/s.
//!
//! A browser can replace neither an enabling device nor an emergency stop.
//!
//! # What it does not do
//!
//! The server has no TLS. Put a proxy in front of it if the network is not trusted.

mod admission;
#[cfg(test)]
mod any_messages;
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
mod viewer_lease;
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

// Compiles the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Reason why a server cannot listen at an address.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BindError {
    /// The address is open to other computers, but the options contain no token.
    #[error(transparent)]
    NoToken(#[from] NoToken),
    /// The operating system refused the address.
    #[error("listening on {address}")]
    Io {
        /// The requested address.
        address: SocketAddr,
        /// The system's error.
        source: io::Error,
    },
}

/// Opens a listener for viewers, on a loopback address or, if the options contain a token, on any
/// address. The listener sets `TCP_NODELAY` on its connections. A back end with its own listener
/// should also set this option. Otherwise a frame can wait up to 40 ms if the page does not answer
/// an earlier message.
///
/// # Errors
/// Returns [`BindError`] if a token is required but missing, or if the system refuses the address.
///
/// # Cancel safety
/// Dropping the future only cancels the call.
pub async fn bind(address: SocketAddr, options: &Options) -> Result<TcpListener, BindError> {
    options.admission.check_listener(address)?;
    listen(address).map_err(|source| BindError::Io { address, source })
}

fn listen(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = match address {
        SocketAddr::V4(_) => TcpSocket::new_v4()?,
        SocketAddr::V6(_) => TcpSocket::new_v6()?,
    };
    // `TcpListener::bind` does the same. On other systems, this option would allow other programs
    // to listen at the same address.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    // Accepted connections inherit this option.
    socket.set_nodelay(true)?;
    socket.bind(address)?;
    socket.listen(WAITING)
}

/// Returns a router with the page and its socket (`/ws`) for a connected robot. The router keeps a
/// handle of the robot. Call this function within a Tokio runtime.
pub fn router(robot: Robot, options: Options) -> Router {
    let admission = options.admission.clone();
    serve(Hub::start(Source::Robot(robot), options), admission)
}

/// Returns a router with the page for a simulated robot that another program controls. Viewers can
/// watch and disturb the robot. If the page should move the robot, connect to it and use [`router`]
/// with [`Options::simulated`].
///
/// # Errors
/// Returns [`Stopped`] if the simulation has ended.
///
/// # Cancel safety
/// Dropping the future only cancels the call.
pub async fn simulator(running: &Arc<Running>, options: Options) -> Result<Router, Stopped> {
    let newest = |robot: &mut franka_sim::Robot| (robot.model().clone(), *robot.state());
    let (model, state) = running.with(newest).await?;
    let watched = Source::Watched(Box::new(Watched::new(model, state)));
    let admission = options.admission.clone();
    let hub = Hub::start(watched, options.simulated(running));
    Ok(serve(hub, admission))
}

fn serve(hub: Arc<Hub>, admission: Admission) -> Router {
    let admissions: Arc<[Admission]> = [admission].into();
    Router::new()
        .route("/ws", get(connect))
        // A page cannot find out why its socket was refused, so it sends a request here.
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

/// Largest number of connections that may wait to be accepted.
const WAITING: u32 = 1024;

/// Largest request in bytes.
const MESSAGE_MAX: usize = 4096;

/// Largest number of bytes that may wait for one viewer's socket.
const WRITE_MAX: usize = 64 * 1024;
