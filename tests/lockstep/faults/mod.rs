//! The fault matrix: every way to control, every fault, every phase of a motion.
//!
//! ```text
//!   Variant (robot, way) x Moment (armed, cycle, finishing) x fault  ->  Expect (outcome and text)
//! ```
//!
//! A case begins a motion of a [`Variant`](variant::Variant), runs it up to a
//! [`Moment`](trial::Moment), injects its fault, and checks the outcome against an
//! [`Expect`](expect::Expect). For every fault, everything resolves once, with the text of the
//! reference client if it has one. Afterwards the thread watches again, and the next motion works,
//! after a recovery or on a new connection if necessary.
//!
//! All failing cases of a test are listed at its end. `FRANKA_FAULT=<name>` runs the cases whose
//! names contain that text, and `FRANKA_FAULT_SEED=<number>` draws other random cycles in addition
//! to the fixed ones.

mod course;
mod cutting;
mod expect;
mod finishing;
mod losing;
mod misbehaving;
mod program;
mod rules;
mod stopping;
mod trial;
mod tripping;
mod variant;

use std::panic::{AssertUnwindSafe, catch_unwind};

use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use trial::Moment;

/// The cases of one test.
struct Matrix {
    test: &'static str,
    filter: Option<String>,
    seed: u64,
    random: SmallRng,
    run: usize,
    failed: Vec<String>,
}

impl Matrix {
    fn new(test: &'static str) -> Self {
        let seed = std::env::var("FRANKA_FAULT_SEED").ok();
        let seed = seed.map_or(1, |seed| seed.parse().expect("a number"));
        Self {
            test,
            filter: std::env::var("FRANKA_FAULT").ok(),
            seed,
            random: SmallRng::seed_from_u64(seed),
            run: 0,
            failed: Vec::new(),
        }
    }

    /// Runs a case, unless `FRANKA_FAULT` excludes it.
    fn case(&mut self, name: impl std::fmt::Display, case: impl FnOnce()) {
        let name = format!("{}/{name}", self.test);
        if (self.filter.as_ref()).is_some_and(|filter| !name.contains(filter)) {
            return;
        }
        self.run += 1;
        // Each case has its own robot, so a panic in one cannot affect another.
        if let Err(panic) = catch_unwind(AssertUnwindSafe(case)) {
            let said = panic.downcast_ref::<String>().map(String::as_str);
            let said = said.or_else(|| panic.downcast_ref().copied()).unwrap_or("");
            self.failed.push(format!("FRANKA_FAULT={name}: {said}"));
        }
    }

    /// A random cycle, from the first answered to the last of a motion along the course.
    fn any_cycle(&mut self) -> Moment {
        Moment::Cycle(self.random.random_range(1..=course::END))
    }

    /// The first and last moments of each phase, and some random cycles in between.
    fn moments(&mut self) -> Vec<Moment> {
        let mut moments = vec![
            Moment::Armed(0),
            Moment::Armed(1),
            Moment::Armed(7),
            Moment::Cycle(1),
            Moment::Cycle(2),
            Moment::Cycle(course::REST + course::RAMP / 2),
            Moment::Cycle(course::END),
            Moment::Finishing(0),
            Moment::Finishing(1),
            Moment::Finishing(12),
        ];
        moments.extend([self.any_cycle(), self.any_cycle()]);
        moments
    }

    /// Panics with the failing cases, if any.
    fn finish(self) {
        let Self {
            test,
            seed,
            run,
            failed,
            ..
        } = self;
        println!("{test}: {run} cases, seed {seed}");
        assert!(
            failed.is_empty(),
            "{} of {run} cases fail with FRANKA_FAULT_SEED={seed}:\n{}",
            failed.len(),
            failed.join("\n")
        );
    }
}
