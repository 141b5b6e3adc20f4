//! The way to the robot, and the network card on it.

use franka_proto::RobotState;

use super::{Check, VENDOR};
use crate::card_errors::CardErrors;
use crate::finding::{Group, Judged, Matters, Needs, Verdict};
use crate::host::{Ethtool, Unread};
use crate::readings::{NET, Readings};

const NETWORK: Check = Check {
    id: "",
    group: Group::NetworkCard,
    matters: Matters::Reading,
    wanted: "",
    why: "",
    source: "",
    reads_only: true,
    judge: route,
};

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "nic.route",
        wanted: "a direct cable to Control's LAN port, own address in the robot's /24",
        why: "Routers and switches add delay and lose packets under load.",
        source: "vendor: FCI documentation, network: 172.16.0.1 and 172.16.0.2, not the Arm's port, no switch",
        judge: route,
        ..NETWORK
    },
    Check {
        id: "nic.kind",
        wanted: "Ethernet on PCI or on the board",
        why: "Wireless loses packets; USB polls; bridges and tunnels delay.",
        source: "vendor: cable required; USB: reports both ways in libfranka issue 131",
        judge: kind,
        ..NETWORK
    },
    Check {
        id: "nic.driver",
        wanted: "igb, igc, e1000e or ixgbe",
        why: "Realtek cards are suspected of delays of 3 ms; an Intel i350 of its own is advised.",
        source: "libfranka issue 205",
        judge: driver,
        ..NETWORK
    },
    Check {
        id: "nic.link",
        wanted: "up, 100 Mb/s or more, full duplex",
        why: "The vendor's minimum is 100BASE-TX.",
        source: VENDOR,
        judge: link,
        ..NETWORK
    },
    Check {
        id: "nic.coalesce",
        wanted: "not adaptive, at most 10 us; warning above 50 us, failure above 300 us",
        why: "The card holds each state back that long before it interrupts.",
        source: "thresholds: this project's, from the millisecond of a cycle",
        judge: coalesce,
        ..NETWORK
    },
    Check {
        id: "nic.eee",
        wanted: "Energy Efficient Ethernet off",
        why: "Waking the link takes tens of microseconds, and some links drop.",
        source: "general knowledge of IEEE 802.3az",
        matters: Matters::Moving,
        judge: eee,
        ..NETWORK
    },
    Check {
        id: "nic.offload",
        wanted: "large receive offload (LRO) off",
        why: "LRO gathers packets before it hands them on.",
        source: "general knowledge of network cards",
        judge: offload,
        ..NETWORK
    },
    Check {
        id: "nic.mtu",
        wanted: "1500",
        why: "With less, more datagrams are split, and one lost fragment loses the state.",
        source: "size of states: FCI protocol; an FER's come in two fragments at 1500",
        judge: mtu,
        ..NETWORK
    },
    Check {
        id: "nic.errors",
        wanted: "none since the card was set up",
        why: "A bad cable shows here and not in a ping.",
        source: "general knowledge of network cards",
        judge: errors,
        ..NETWORK
    },
    Check {
        id: "nic.power",
        wanted: "power control `on`, ASPM not `powersave`",
        why: "A card that sleeps takes longer for the next packet.",
        source: "general knowledge of Linux kernels",
        matters: Matters::Moving,
        judge: card_power,
        ..NETWORK
    },
    Check {
        id: "nic.two_robots",
        wanted: "one interface in the robot's network",
        why: "With two, answers leave by the wrong cable.",
        source: "general knowledge of routing",
        judge: two_robots,
        ..NETWORK
    },
    Check {
        id: "net.busy_poll",
        wanted: "any",
        why: "The option busy_poll of the driver sets it for its own socket.",
        source: "general knowledge of Linux kernels",
        matters: Matters::Moving,
        judge: busy_poll,
        ..NETWORK
    },
];

/// The interface on the way to the robot, or what to say where there is no card.
fn card(readings: &Readings<'_>) -> Result<Result<String, Judged>, Unread> {
    let interface = readings.route()?.interface;
    Ok(match interface == "lo" {
        true => Err(Judged::info("the robot is on this computer: no card")),
        false => Ok(interface),
    })
}

/// Names the interface on the way to the robot, or returns what to say where there is no card.
macro_rules! card {
    ($readings:expr) => {
        match card($readings)? {
            Ok(interface) => interface,
            Err(judged) => return Ok(judged),
        }
    };
}

fn route(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let robot = match readings.robot {
        Some(robot) => robot,
        None => return Err(Unread::Absent("the robot's IPv4 address".into())),
    };
    let route = match readings.route() {
        Ok(route) => route,
        // The system says so when it knows no way.
        Err(Unread::Failed(_, why)) => return Ok(Judged::failure(format!("no way: {why}"))),
        Err(unread) => return Err(unread),
    };
    let read = format!("by {} from {}", route.interface, route.own);
    let near = u32::from(robot) >> 8 == u32::from(route.own) >> 8;
    Ok(match route.gateway {
        _ if route.interface == "lo" => Judged::info(format!("{read}: on this computer")),
        Some(_) => Judged::warning(format!("{read}, through a router")),
        None if near => Judged::good(format!("{read}, directly")),
        None => Judged::warning(format!("{read}, directly, not in the robot's /24")),
    })
}

fn kind(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let path = format!("{NET}/{card}");
    let is = |name: &str| readings.host.list(&format!("{path}/{name}")).is_ok();
    let target = readings.host.link(&path)?;
    readings.note(path.as_str(), target.as_str());
    let has_file = |name: &str| readings.host.read(&format!("{path}/{name}")).is_ok();
    Ok(if is("wireless") || is("phy80211") {
        Judged::failure(format!("{card} is wireless"))
    } else if target.contains("/usb") {
        Judged::warning(format!("{card} is on USB"))
    } else if is("bridge") || is("brport") || is("bonding") {
        Judged::warning(format!("{card} is a bridge or a bond, or part of one"))
    } else if has_file("tun_flags") || card.starts_with("wg") {
        Judged::warning(format!("{card} is a tunnel"))
    } else if target.contains("/virtual/") {
        Judged::warning(format!("{card} is a virtual interface"))
    } else if target.contains("/virtio") {
        Judged::warning(format!("{card} is a card of a virtual machine"))
    } else if target.contains("/pci") || target.contains("/platform/") {
        Judged::good(format!("{card} is a card of this computer"))
    } else {
        Judged::info(format!("{card}: {target}"))
    })
}

fn driver(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let _ = card!(readings);
    let answer = readings.ethtool(Ethtool::Driver)?;
    // `struct ethtool_drvinfo`: the command, then names of 32 bytes.
    let (name, version) = (answer.text(4..36), answer.text(36..68));
    let read = format!("{name} {version}");
    Ok(match name.as_str() {
        "igb" | "igc" | "e1000e" | "ixgbe" => Judged::good(read),
        "r8125" | "r8126" | "r8169" => Judged::info(format!("{read}: suspected of delays of 3 ms")),
        _ => Judged::info(read),
    })
}

fn link(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let state = readings.card("operstate")?;
    if state == "down" || state == "lowerlayerdown" {
        return Ok(Judged::failure(format!("{card} is {state}"))
            .fix(Needs::Nothing, format!("sudo ip link set {card} up")));
    }
    // Reading these fails with EINVAL where the driver does not know.
    let (speed, duplex) = (readings.card("speed"), readings.card("duplex"));
    let (Ok(speed), Ok(duplex)) = (speed, duplex) else {
        return Ok(Judged::unknown(format!(
            "unknown: {card} is {state}, and its driver names no speed"
        )));
    };
    let read = format!("{card} is {state}, {speed} Mb/s, {duplex} duplex");
    Ok(match speed.parse::<i64>() {
        _ if duplex == "half" => Judged::failure(read),
        Ok(speed) if speed >= 100 && duplex == "full" => Judged::good(read),
        Ok(1..100) => Judged::warning(read),
        _ => Judged::unknown(format!("unknown: {read}")),
    })
}

fn coalesce(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let answer = readings.ethtool(Ethtool::Coalescing)?;
    // `struct ethtool_coalesce`, in words after the command: rx_coalesce_usecs,
    // rx_max_coalesced_frames, eight more, and use_adaptive_rx_coalesce.
    let (us, frames, adaptive) = (answer.word(4), answer.word(8), answer.word(44) != 0);
    let with = if adaptive { "adaptive, " } else { "" };
    let read = format!("{with}{us} us, {frames} frames");
    // These drivers take small numbers for modes: 3 changes with the load.
    let driver = readings
        .ethtool(Ethtool::Driver)
        .map(|answer| answer.text(4..36));
    let mode = driver.is_ok_and(|name| ["igb", "igc"].contains(&name.as_str())) && us == 3;
    let verdict = match us {
        301.. => Verdict::Failure,
        51..=300 => Verdict::Warning,
        _ if adaptive => Verdict::Warning,
        11..=50 => Verdict::Info,
        3 if mode => Verdict::Info,
        _ => Verdict::Good,
    };
    let read = if mode {
        format!("{read}: a mode that goes by the load")
    } else {
        read
    };
    Ok(Judged::new(verdict, read).fix(
        Needs::Nothing,
        format!("sudo ethtool -C {card} adaptive-rx off rx-usecs 0 rx-frames 1"),
    ))
}

fn eee(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let answer = readings.ethtool(Ethtool::Eee)?;
    // `struct ethtool_eee`, in words: command, supported, advertised, lp_advertised, eee_active,
    // eee_enabled.
    let (active, enabled) = (answer.word(16) != 0, answer.word(20) != 0);
    Ok(match (enabled, active) {
        (false, false) => Judged::good("off"),
        (_, true) => Judged::warning("on and in use"),
        (true, false) => Judged::warning("on, not in use"),
    }
    .fix(
        Needs::Nothing,
        format!("sudo ethtool --set-eee {card} eee off"),
    ))
}

fn offload(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let lro = readings.ethtool(Ethtool::Flags)?.word(4) & ETH_FLAG_LRO != 0;
    Ok(match lro {
        false => Judged::good("LRO off"),
        true => {
            Judged::info("LRO on").fix(Needs::Nothing, format!("sudo ethtool -K {card} lro off"))
        }
    })
}

/// `linux/ethtool.h`.
const ETH_FLAG_LRO: u32 = 1 << 15;

fn mtu(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let mtu: u32 = readings.number(&format!("{NET}/{card}/mtu"))?;
    // Headers of IP and UDP have 20 and 8 bytes, and all fragments but the last a multiple of 8.
    let bytes = RobotState::MAX_SIZE as u32 + 8;
    let packets = match mtu.saturating_sub(20) {
        room if room >= bytes => 1,
        room => bytes.div_ceil((room / 8 * 8).max(8)),
    };
    let read = format!("{mtu}: the longest state comes in {packets} packets");
    Ok(match mtu {
        1500 => Judged::good(read),
        ..1500 => Judged::warning(read),
        _ => Judged::info(read),
    }
    .fix(Needs::Nothing, format!("sudo ip link set {card} mtu 1500")))
}

fn errors(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let _ = card!(readings);
    Ok(CardErrors::read(readings)?.judged())
}

fn card_power(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let control = readings.card("device/power/control")?;
    let aspm = readings.text("/sys/module/pcie_aspm/parameters/policy");
    let saves = aspm
        .as_ref()
        .is_ok_and(|policy| policy.contains("[powersave]") || policy.contains("[powersupersave]"));
    let mut read = format!("power control {control}");
    if let Ok(policy) = aspm {
        read += &format!(", ASPM {policy}");
    }
    Ok(match control.as_str() {
        "on" if !saves => Judged::good(read),
        "on" => Judged::warning(read).fix(
            Needs::Nothing,
            "echo performance | sudo tee /sys/module/pcie_aspm/parameters/policy",
        ),
        _ => Judged::warning(read).fix(
            Needs::Nothing,
            format!("echo on | sudo tee {NET}/{card}/device/power/control"),
        ),
    })
}

fn two_robots(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = card!(readings);
    let others = readings.route()?.others;
    Ok(match others.is_empty() {
        true => Judged::good(format!("{card} only")),
        false => Judged::failure(format!("{card}, and {}", others.join(", "))),
    })
}

fn busy_poll(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let us: u64 = readings.number("/proc/sys/net/core/busy_poll")?;
    Ok(Judged::info(format!("{us} us")))
}
