//! Opens a connection to an address. If the robot refuses the version and names an older one, the
//! driver tries the older version.

use std::net::SocketAddr;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::client::Session;
use franka_proto::{RobotState, Version};
use franka_rt::driver::{Driver, LinkTimeout, ReferenceReader};
use franka_rt::lifecycle::Lifecycle;
use franka_rt::thread::{Handle, Notice, ThreadConfig};
use tokio::sync::watch;
use tokio_util::codec::Framed;

use crate::bridge::{Bridge, Prepared};
use crate::builder::{Builder, VersionPolicy};
use crate::codec::MessageCodec;
use crate::command_channel::Channel;
use crate::connected_model;
use crate::dial::{dial, dial_one, resolve};
use crate::error::ConnectError;
use crate::geometry_check::{Comparison, GeometryCheck};
use crate::handshake::shake_hands;
use crate::link::Link;
use crate::newest_state::Newest;
use crate::progress::Course;
use crate::supervisor::Supervisor;
use crate::thresholds::Thresholds;
use crate::world::{self, StatePort, Stream, Wake, timeout, timeout_at};

/// A connection whose bridge does not run yet.
pub(crate) struct Opened {
    pub(crate) model: Arc<Model>,
    pub(crate) version: Version,
    pub(crate) link: Link,
    pub(crate) first: RobotState,
    /// The bridge, which is started once the supervisor knows of the connection.
    pub(crate) bridge: Prepared,
}

/// Opens a connection, which will publish to `states` and report to `supervisor`.
pub(crate) async fn open(
    builder: &Builder,
    states: &Arc<watch::Sender<RobotState>>,
    supervisor: &Arc<Supervisor>,
) -> Result<Opened, ConnectError> {
    // Check before anything is sent, as libfranka does. The thread makes its own requests later.
    let scheduling = builder.scheduling.clone();
    off_worker(move || scheduling.probe()).await??;

    let limit = builder.connect_timeout;
    let addresses = resolve(&builder.endpoint, Version::TCP_PORT, limit).await?;
    let (tcp, address) = dial(&addresses, limit).await?;
    let mut session = negotiate(tcp, address, builder).await?;
    let (reader, state_wakeups) = (&session.handle.states, &session.handle.state_wakeups);
    let newest = Newest::new(
        (session.first, reader.clone()),
        states,
        state_wakeups.clone(),
    );
    let shown = newest.clone();
    let mode = move || shown.state().robot_mode;
    let (channel, connection, reports) = Channel::start(session.stream, session.session, mode);
    #[cfg(feature = "record")]
    let channel = channel.with_journal(supervisor.journal());
    let course = Course::new(session.references);
    let thresholds = Thresholds::default();
    let stats = session.handle.stats.clone();
    let granted = Arc::new(session.handle.granted.clone());
    let lender = session.handle.lender.clone();
    let cycles = session.handle.cycles.clone();
    let (model, mut description) = connected_model::of(session.version, &channel, builder).await?;
    if description.is_none() && builder.policy.is_some() {
        // Only supervision compares robots. A model library has megabytes.
        description = connected_model::hash_of(session.version, &channel, limit).await;
    }
    let newer = (&mut session.handle, &session.wake);
    let (model, geometry) = check_geometry(model, &session.first, newer, builder).await?;
    let model = Arc::new(model);
    let mut lifecycle = Lifecycle::new(model.clone(), session.version)
        .with_log_size(builder.log_size)
        .with_link_timeout(LinkTimeout::new(builder.link_timeout)?);
    if let Some(known) = &builder.known {
        known.check(model.kind())?;
        lifecycle = lifecycle.knowing(**known);
    }
    let bridge = Bridge::new(
        lifecycle,
        session.handle,
        session.wake,
        (channel.clone(), connection),
        states.clone(),
        (course.clone(), thresholds.clone()),
        supervisor.clone(),
    );
    let (bridge, prepared) = bridge.prepare(reports);
    Ok(Opened {
        model,
        version: session.version,
        link: Link {
            address,
            description,
            geometry,
            bridge,
            channel,
            newest,
            course,
            thresholds,
            stats,
            granted,
            lender,
            cycles,
        },
        first: session.first,
        bridge: prepared,
    })
}

struct Negotiated {
    version: Version,
    stream: Framed<Stream, MessageCodec>,
    session: Session,
    handle: Handle,
    references: ReferenceReader,
    wake: Wake,
    first: RobotState,
}

/// Opens a session on a new connection to `address`, with the version that the policy allows and
/// the robot accepts.
async fn negotiate(
    tcp: Stream,
    address: SocketAddr,
    builder: &Builder,
) -> Result<Negotiated, ConnectError> {
    let announced = match builder.versions {
        VersionPolicy::Exact(version) => version,
        VersionPolicy::Negotiate => Version::V10,
    };
    match open_with(announced, tcp, address, builder).await {
        Err(ConnectError::IncompatibleVersion(refusal))
            if builder.versions == VersionPolicy::Negotiate =>
        {
            match Version::from_number(refusal.server_version) {
                Some(older) if older != announced => {
                    let tcp = dial_one(address, builder.connect_timeout).await?;
                    open_with(older, tcp, address, builder).await
                }
                _ => Err(refusal.into()),
            }
        }
        opened => opened,
    }
}

async fn open_with(
    version: Version,
    tcp: Stream,
    address: SocketAddr,
    builder: &Builder,
) -> Result<Negotiated, ConnectError> {
    let port = StatePort::open(address.ip())?;
    let number = port.number()?;
    let mut stream = Framed::new(tcp, MessageCodec::ROBOT);
    let mut session = Session::new(version);
    timeout(
        builder.connect_timeout,
        shake_hands(&mut stream, &mut session, number),
    )
    .await
    .unwrap_or(Err(ConnectError::HandshakeTimeout { address }))?;

    let config = ThreadConfig {
        scheduling: builder.scheduling.clone(),
        ..ThreadConfig::default()
    };
    let link_timeout = LinkTimeout::new(builder.link_timeout)?;
    let driver = Driver::new(version).with_link_timeout(link_timeout);
    let references = driver.references();
    let start = move || port.control_thread(config, driver, version);
    let mut handle = off_worker(start).await??;
    let wake = Wake::attach(handle.event_fd.clone())?;
    let first = timeout(builder.connect_timeout, newer_state(&mut handle, &wake))
        .await
        .map_err(|_| ConnectError::NoState { address })??;
    Ok(Negotiated {
        version,
        stream,
        session,
        handle,
        references,
        wake,
        first,
    })
}

/// Runs work that blocks for milliseconds on a thread where no other task waits: starting and
/// joining threads, or locking and touching memory. Dropping the future discards the result.
async fn off_worker<T: Send + 'static>(
    blocking: impl FnOnce() -> T + Send + 'static,
) -> std::io::Result<T> {
    let done = world::spawn_blocking(blocking).await;
    done.map_err(std::io::Error::other)
}

/// Compares the model with the poses of this state, and then of newer states until one agrees.
/// Returns the model to use.
async fn check_geometry(
    model: Model,
    first: &RobotState,
    (handle, wake): (&mut Handle, &Wake),
    builder: &Builder,
) -> Result<(Model, GeometryCheck), ConnectError> {
    let mut comparison = Comparison::new(model, first);
    let deadline = world::now() + builder.connect_timeout;
    while comparison.needs_more() {
        // If no more states arrive, the states so far count.
        let Ok(state) = timeout_at(deadline, newer_state(handle, wake)).await else {
            break;
        };
        comparison.look_at(&state?);
    }
    let before = builder.geometry_before.as_ref();
    comparison.conclude(builder.accept_geometry_error, before)
}

/// Waits for a state that was not read before. Fails if none comes, because control needs a first
/// state.
async fn newer_state(handle: &mut Handle, wake: &Wake) -> Result<RobotState, ConnectError> {
    loop {
        wake.woken().await?;
        if let Some(state) = handle.states.newest() {
            return Ok(state);
        }
        while let Some(notice) = handle.notices.pop() {
            if let Notice::Link(fault) = notice {
                return Err(fault.into());
            }
        }
    }
}
