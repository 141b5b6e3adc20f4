//! Several robots on one server, with one page per robot and one page for all robots.

use std::collections::BTreeSet;
use std::sync::Arc;

use axum::Router;
use axum::middleware::from_fn_with_state;
use axum::response::{Json, Redirect};
use axum::routing::get;
use franka_async::Robot;
use franka_async::connection::admission::Admission;

use crate::hub::Hub;
use crate::options::Options;
use crate::source::Source;
use crate::{admission, page, serve};

/// Reason why a robot's name is invalid. The names are parts of page addresses.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameError {
    /// The name is empty, has more than 40 characters, or contains characters other than letters,
    /// digits and `-_.:~`.
    #[error(
        "got the name {name:?}, expected 1 to 40 characters of a-z, A-Z, 0-9 and -_.:~, since \
        it is part of an address"
    )]
    Characters {
        /// The name.
        name: String,
    },
    /// Two robots have the same name, or the page has a file with this name.
    #[error("the name {name:?} is already in use, expected a different one")]
    Taken {
        /// The name.
        name: String,
    },
}

/// Returns a router with the pages of several robots. The page of each robot is at `/NAME/`, as
/// served by [`router`](crate::router). The page at `/` shows all robots side by side, and its
/// viewers can only watch and stop them. For each robot, a different viewer can hold the lease that
/// moves it. Use the same token for all robots. Call this function within a Tokio runtime.
///
/// # Errors
/// Returns [`NameError`] if a name is invalid. No page has been started in this case.
pub fn several<N: Into<String>>(
    robots: impl IntoIterator<Item = (N, Robot, Options)>,
) -> Result<Router, NameError> {
    let robots: Vec<_> = robots
        .into_iter()
        .map(|(name, robot, options)| (name.into(), robot, options))
        .collect();
    let mut names = BTreeSet::new();
    for (name, ..) in &robots {
        let taken = page::is_file(name) || !names.insert(name);
        let name = name.clone();
        if !is_part_of_an_address(&name) {
            return Err(NameError::Characters { name });
        } else if taken {
            return Err(NameError::Taken { name });
        }
    }
    let names: Arc<[String]> = robots.iter().map(|(name, ..)| name.clone()).collect();
    let admissions = robots.iter().map(|(.., options)| options.admission.clone());
    let admissions: Arc<[Admission]> = admissions.collect();
    let listed = Json(names.to_vec());
    let mut router = Router::new()
        .route("/robots.json", get(async move || listed))
        .layer(from_fn_with_state(admissions.clone(), admission::rest))
        .merge(page::overview().layer(from_fn_with_state(admissions, admission::files)));
    for (name, robot, options) in robots {
        let options = Options {
            siblings: names.clone(),
            ..options
        };
        let admission = options.admission.clone();
        let there = format!("/{name}/");
        let redirect = Redirect::permanent(&there);
        router = router
            .route(&format!("/{name}"), get(async || redirect))
            .nest(
                &there,
                serve(Hub::start(Source::Robot(robot), options), admission),
            );
    }
    Ok(router)
}

fn is_part_of_an_address(name: &str) -> bool {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.:~".contains(c);
    // A name that consists of dots, such as `..`, is a relative folder.
    (1..=40).contains(&name.len()) && name.chars().all(fits) && name.contains(|c| c != '.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parts_of_addresses() {
        for (name, fits) in [
            ("left", true),
            ("172.16.0.2:1337", true),
            ("robot_2", true),
            ("", false),
            ("..", false),
            ("a/b", false),
            ("{robot}", false),
            ("müller", false),
            ("[fe80::1]", false),
        ] {
            assert_eq!(is_part_of_an_address(name), fits, "{name}");
        }
    }
}
