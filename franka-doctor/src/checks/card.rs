//! Checks of the network card on the route to the robot. They use the card's driver and its error
//! counts.

use super::network::NETWORK;
use super::{Check, VENDOR};
use crate::card_errors::CardErrors;
use crate::finding::{Judged, Matters, Needs, Verdict};
use crate::host::{Ethtool, Unread};
use crate::readings::{NET, Readings};

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "nic.driver",
        wanted: "igb, igc, e1000e or ixgbe",
        why: "Realtek cards are suspected of delays of 3 ms; a separate Intel i350 card is \
            recommended.",
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
        wanted: "not adaptive, at most 10 us; a warning above 50 us, a failure above 300 us",
        why: "The card delays each state by this time before it interrupts the processor.",
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
        id: "nic.ring",
        wanted: "any",
        why: "Buffers for packets that the kernel has not read yet; a state needs one or two.",
        source: "general knowledge of network cards",
        judge: rings,
        ..NETWORK
    },
    Check {
        id: "nic.pause",
        wanted: "pause frames off",
        why: "With pause frames, the other end may make the card delay commands.",
        source: "general knowledge of IEEE 802.3",
        judge: pause,
        ..NETWORK
    },
    Check {
        id: "nic.offload",
        wanted: "large receive offload (LRO) off; generic receive offload (GRO) may be on",
        why: "LRO delays packets to merge them; GRO merges only packets that have already arrived.",
        source: "general knowledge of network cards",
        judge: offload,
        ..NETWORK
    },
    Check {
        id: "nic.errors",
        wanted: "none since the card was set up",
        why: "A bad cable causes errors here, but not in a ping.",
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
];

fn driver(readings: &Readings<'_>) -> Result<Judged, Unread> {
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
    let card = readings.interface()?;
    let state = readings.card("operstate")?;
    if state == "down" || state == "lowerlayerdown" {
        return Ok(Judged::failure(format!("{card} is {state}"))
            .fix(Needs::Nothing, format!("sudo ip link set {card} up")));
    }
    // A read fails with EINVAL if the driver does not know the value.
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
    let card = readings.interface()?;
    let answer = readings.ethtool(Ethtool::Coalescing)?;
    // `struct ethtool_coalesce`, in words after the command: rx_coalesce_usecs,
    // rx_max_coalesced_frames, eight more, and use_adaptive_rx_coalesce.
    let (us, frames, adaptive) = (answer.word(4), answer.word(8), answer.word(44) != 0);
    let with = if adaptive { "adaptive, " } else { "" };
    let read = format!("{with}{us} us, {frames} frames");
    // These drivers use small numbers as modes. Mode 3 adapts to the load.
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
        format!("{read}: a mode that depends on the load")
    } else {
        read
    };
    Ok(Judged::new(verdict, read).fix(
        Needs::Nothing,
        format!("sudo ethtool -C {card} adaptive-rx off rx-usecs 0 rx-frames 1"),
    ))
}

fn eee(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = readings.interface()?;
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
    let card = readings.interface()?;
    let lro = readings.ethtool(Ethtool::Flags)?.word(4) & ETH_FLAG_LRO != 0;
    let gro = match readings.ethtool(Ethtool::Gro) {
        Ok(answer) if answer.word(4) != 0 => ", GRO on",
        Ok(_) => ", GRO off",
        Err(_) => "",
    };
    Ok(match lro {
        false => Judged::good(format!("LRO off{gro}")),
        true => Judged::info(format!("LRO on{gro}"))
            .fix(Needs::Nothing, format!("sudo ethtool -K {card} lro off")),
    })
}

fn rings(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let answer = readings.ethtool(Ethtool::Rings)?;
    // `struct ethtool_ringparam`, in words: command, the maxima of rx, rx_mini, rx_jumbo and tx,
    // then the current values.
    let [rx_max, tx_max, rx, tx] = [4, 16, 20, 32].map(|offset| answer.word(offset));
    Ok(Judged::info(format!(
        "receive buffers: {rx} of {rx_max}; send buffers: {tx} of {tx_max}"
    )))
}

fn pause(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = readings.interface()?;
    let answer = readings.ethtool(Ethtool::Pause)?;
    // `struct ethtool_pauseparam`, in words: command, autoneg, rx_pause, tx_pause.
    let [by_agreement, obeyed, sent] = [4, 8, 12].map(|offset| answer.word(offset) != 0);
    if !obeyed && !sent {
        return Ok(Judged::good("off"));
    }
    let read = match (obeyed, sent) {
        (true, true) => "obeyed and sent",
        (true, false) => "obeyed",
        _ => "sent",
    };
    let read = match by_agreement {
        true => format!("{read}, if the other end agrees"),
        false => read.into(),
    };
    Ok(Judged::info(read).fix(
        Needs::Nothing,
        format!("sudo ethtool -A {card} autoneg off rx off tx off"),
    ))
}

/// Flag of large receive offload, from `linux/ethtool.h`.
const ETH_FLAG_LRO: u32 = 1 << 15;

fn errors(readings: &Readings<'_>) -> Result<Judged, Unread> {
    Ok(CardErrors::read(readings)?.judged())
}

fn card_power(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = readings.interface()?;
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
