//! The measured values of one arm, and the figures of all arms.

use std::collections::BTreeMap;
use std::fmt;

use franka_bench::figures::quantile;

/// The figures of one arm's programme.
#[derive(Debug, Default)]
pub(crate) struct ArmFigures {
    pub(crate) seed: u64,
    /// The reason if the programme ended early.
    pub(crate) reflex: Option<String>,
    /// Number of goals with a target.
    pub(crate) goals: usize,
    /// The goals that did not arrive, each with its number and its result. The arm is not held
    /// while they are counted.
    pub(crate) short: Vec<String>,
    /// Distances from the target at rest, `[mm]` and `[mrad]`.
    pub(crate) errors_mm: Vec<f64>,
    pub(crate) errors_mrad: Vec<f64>,
    /// Times from a step of 5 cm until the arm stays within 1 mm, `[s]`.
    pub(crate) arrive_s: Vec<f64>,
    /// Times until a goal was reported as arrived, `[s]`.
    pub(crate) told_s: Vec<f64>,
    /// Distances from the reference during the stream, `[mm]`.
    pub(crate) lags_mm: Vec<f64>,
    /// The same on the circle, `[mm]`.
    pub(crate) circle_lags_mm: Vec<f64>,
    /// The robot's estimate of the external force at rest, without a contact, `[N]`.
    pub(crate) estimates_n: Vec<f64>,
    /// Peak-to-peak motion of the end effector during a hold, `[mm]`.
    pub(crate) hold_move_mm: f64,
    /// Torque command above 30 Hz, rms of the worst joint, `[N m]`.
    pub(crate) hold_torque_hf_nm: f64,
    pub(crate) moving_torque_hf_nm: f64,
    /// Additional distance of an arm from the target after the robot's own controller has taken
    /// over at the end of a motion, `[mm]`.
    pub(crate) handover_mm: f64,
    /// The part of it until the end of the torques, `[mm]`.
    pub(crate) released_mm: f64,
    /// Force of a pushing hand without the contribution of the inertia, `[N]`.
    pub(crate) push_force_n: f64,
    /// Greatest distances from a held pose in the third second after a push has ended, `[mm]` and
    /// `[mrad]`.
    pub(crate) pushed_mm: Vec<f64>,
    pub(crate) pushed_mrad: Vec<f64>,
    /// Motions to the held pose that did not arrive after such a push.
    pub(crate) pushed_short: usize,
    /// Displacement of the robot's own controller under a push of 30 N, `[mm]`.
    pub(crate) push_yield_mm: f64,
    /// Force of a hand that guides the arm at up to 0.16 m/s, `[N]`.
    pub(crate) guide_force_n: f64,
    /// Overshoot of a released arm beyond its target, `[mm]`.
    pub(crate) release_overshoot_mm: f64,
}

impl ArmFigures {
    pub(crate) fn fell_short(&self) -> bool {
        self.reflex.is_some() || !self.short.is_empty()
    }
}

impl fmt::Display for ArmFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "seed {}: {} of {} goals short; {:.2} mm {:.2} mrad at most; 5 cm {:.2} s; lag p95 {:.1} mm; \
             hold {:.3} mm, {:.3} N m; moving {:.3} N m; push {:.1} N, overshoot {:.1} mm; \
             after pushes {:.2} mm, {} short",
            self.seed,
            self.short.len(),
            self.goals,
            quantile(&self.errors_mm, 1.0),
            quantile(&self.errors_mrad, 1.0),
            quantile(&self.arrive_s, 0.5),
            quantile(&self.lags_mm, 0.95),
            self.hold_move_mm,
            self.hold_torque_hf_nm,
            self.moving_torque_hf_nm,
            self.push_force_n,
            self.release_overshoot_mm,
            self.pushed_mm.iter().copied().fold(0.0, f64::max),
            self.pushed_short,
        )?;
        for short in &self.short {
            write!(f, "\n  {short}")?;
        }
        match &self.reflex {
            Some(reflex) => write!(f, "\n  {reflex}"),
            None => Ok(()),
        }
    }
}

/// The figures of all arms, by the names of the file.
pub(crate) struct Summary(BTreeMap<String, f64>);

impl Summary {
    pub(crate) fn of(arms: &[ArmFigures]) -> Self {
        let mut values = BTreeMap::new();
        let mut put = |name: &str, value: f64| {
            values.insert(format!("arms.{name}"), value);
        };
        let sum = |of: fn(&ArmFigures) -> usize| arms.iter().map(|arm| of(arm) as f64).sum::<f64>();
        let most = |of: fn(&ArmFigures) -> f64| arms.iter().map(of).fold(0.0, f64::max);
        let all = |of: fn(&ArmFigures) -> &Vec<f64>| -> Vec<f64> {
            arms.iter().flat_map(of).copied().collect()
        };
        put("count", arms.len() as f64);
        let short = sum(|arm| arm.short.len());
        put("arrived_share", 1.0 - short / sum(|arm| arm.goals));
        put("wrong_short", short);
        put("reflexes", sum(|arm| usize::from(arm.reflex.is_some())));
        let mm = all(|arm| &arm.errors_mm);
        let mrad = all(|arm| &arm.errors_mrad);
        for (name, share) in [("p50", 0.5), ("p99", 0.99), ("max", 1.0)] {
            put(&format!("error_mm_{name}"), quantile(&mm, share));
            put(&format!("error_mrad_{name}"), quantile(&mrad, share));
        }
        let arrive = all(|arm| &arm.arrive_s);
        let told = all(|arm| &arm.told_s);
        for (name, share) in [("p50", 0.5), ("p99", 0.99)] {
            put(&format!("arrive_s_{name}"), quantile(&arrive, share));
            put(&format!("told_s_{name}"), quantile(&told, share));
        }
        let lags = all(|arm| &arm.lags_mm);
        put("stream_lag_mm_p50", quantile(&lags, 0.5));
        put("stream_lag_mm_p95", quantile(&lags, 0.95));
        let circle = all(|arm| &arm.circle_lags_mm);
        put("circle_lag_mm_p95", quantile(&circle, 0.95));
        put("guide_force_n_max", most(|arm| arm.guide_force_n));
        let estimates = all(|arm| &arm.estimates_n);
        put("estimate_n_p99", quantile(&estimates, 0.99));
        put("estimate_n_max", quantile(&estimates, 1.0));
        put("hold_move_mm_max", most(|arm| arm.hold_move_mm));
        put("hold_torque_hf_nm_max", most(|arm| arm.hold_torque_hf_nm));
        put(
            "moving_torque_hf_nm_max",
            most(|arm| arm.moving_torque_hf_nm),
        );
        put("handover_mm_max", most(|arm| arm.handover_mm));
        put("released_mm_max", most(|arm| arm.released_mm));
        put("push_force_n_max", most(|arm| arm.push_force_n));
        let pushed_mm = all(|arm| &arm.pushed_mm);
        let pushed_mrad = all(|arm| &arm.pushed_mrad);
        if !pushed_mm.is_empty() {
            for (name, share) in [("p50", 0.5), ("p99", 0.99), ("max", 1.0)] {
                put(&format!("pushed_mm_{name}"), quantile(&pushed_mm, share));
                put(
                    &format!("pushed_mrad_{name}"),
                    quantile(&pushed_mrad, share),
                );
            }
        }
        put("pushed_short", sum(|arm| arm.pushed_short));
        put("push_yield_mm_max", most(|arm| arm.push_yield_mm));
        put(
            "release_overshoot_mm_max",
            most(|arm| arm.release_overshoot_mm),
        );
        Self(values)
    }

    pub(crate) fn values(&self) -> &BTreeMap<String, f64> {
        &self.0
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in &self.0 {
            writeln!(f, "{name:32} {value:.4}")?;
        }
        Ok(())
    }
}
