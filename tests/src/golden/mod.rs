//! Golden vectors: the crates against numbers and bytes that other implementations produced.
//!
//! ```text
//! DIR/<file>.json -> Node (checked access, names the place of a fault)
//!                 -> Suite::check (one per file) -> Report -> one line of output
//! ```
//!
//! A suite is a row of [`SUITES`]: the file it reads, below the directory of the vectors, and the
//! function that checks it. To add one, write `golden/<subject>.rs` with a function like this and
//! add the row:
//!
//! ```
//! use franka_tests::golden::{Malformed, Node, Report};
//!
//! pub fn check(root: &Node<'_>) -> Result<Report, Malformed> {
//!     let mut report = Report::default();
//!     for sample in root.get("samples")?.list()? {
//!         let (q, expected) = (sample.get("q")?.numbers::<2>()?, sample.get("sum")?.number()?);
//!         report.case(sample.path(), |case| case.near("sum", &[q[0] + q[1]], &[expected], 1e-12));
//!     }
//!     Ok(report)
//! }
//! # let value = serde_json::json!({ "samples": [{ "q": [1.0, 2.0], "sum": 3.0 }] });
//! # assert_eq!(check(&Node::root(&value)).unwrap().passed(), 1);
//! ```

mod analytic_ik;
mod control_loop;
mod link_surfaces;
mod model;
mod node;
mod otg;
mod report;
mod run;
mod shaping;
mod shaping_errors;
mod shaping_filter;
mod wire;
mod wire_datagrams;
mod wire_end_effectors;
mod wire_table;

pub use node::{Malformed, Node};
pub use report::{Case, Failure, Report, Worst};
pub use run::{Outcome, Suite, Verdict, failed, run};

/// Every file of vectors that the project checks, in the order of the crates.
pub const SUITES: &[Suite] = &[
    Suite {
        file: "wire_v10.json",
        check: wire_table::headers,
    },
    Suite {
        file: "wire_v5.json",
        check: wire_table::headers,
    },
    Suite {
        file: "wire_gripper.json",
        check: wire_end_effectors::gripper_headers,
    },
    Suite {
        file: "wire_vacuum_gripper.json",
        check: wire_end_effectors::vacuum_headers,
    },
    Suite {
        file: "wire_golden.json",
        check: wire::messages,
    },
    Suite {
        file: "model/model_vectors_fr3.json",
        check: model::fr3,
    },
    Suite {
        file: "model/model_vectors_fer.json",
        check: model::fer,
    },
    Suite {
        file: "model/model_vectors_fer.json",
        check: model::fer_physically_consistent,
    },
    Suite {
        file: "model/velocity_limit_vectors_fr3.json",
        check: model::velocity_envelope,
    },
    Suite {
        file: "model/link_surfaces.json",
        check: link_surfaces::covered,
    },
    Suite {
        file: "model/ik_vectors.json",
        check: analytic_ik::all,
    },
    Suite {
        file: "otg/single_axis.json",
        check: otg::single_axis,
    },
    Suite {
        file: "otg/multi_axis.json",
        check: otg::multi_axis,
    },
    Suite {
        file: "otg/single_axis_target_velocity.json",
        check: otg::target_velocity,
    },
    Suite {
        file: "otg/single_axis_unavoidable_excess.json",
        check: otg::target_velocity,
    },
    Suite {
        file: "rate_limiting_vectors.json",
        check: shaping::limiters,
    },
    Suite {
        file: "lowpass_vectors.json",
        check: shaping_filter::filters,
    },
    Suite {
        file: "control_loop_vectors.json",
        check: control_loop::traces,
    },
];
