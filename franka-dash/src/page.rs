//! The files of the page, which are compiled into the program. `cargo xtask assets` generates them.

use axum::Router;
use axum::extract::OriginalUri;
use axum::http::{HeaderName, StatusCode, header};
use axum::response::IntoResponse;
use axum::routing::get;

pub(crate) fn routes<S: Clone + Send + Sync + 'static>() -> Router<S> {
    files(INDEX)
}

/// Returns the routes for the files of the page that shows several robots.
pub(crate) fn overview<S: Clone + Send + Sync + 'static>() -> Router<S> {
    files(OVERVIEW)
}

/// Returns true if a page has a file or a folder with this name.
pub(crate) fn is_file(name: &str) -> bool {
    let first = |path: &str| path.split('/').nth(1) == Some(name);
    let files = FILES.iter().chain(COMPRESSED).chain(MESHES);
    let mut paths = files.map(|(path, ..)| path);
    paths.any(|path| first(path)) || ["ws", "access", "robots.json"].contains(&name)
}

/// Returns the routes for all files. `page` is the main page.
fn files<S: Clone + Send + Sync + 'static>(page: &'static [u8]) -> Router<S> {
    let first = async move |OriginalUri(asked): OriginalUri| {
        if asked.path().ends_with('/') {
            (headers(HTML), page).into_response()
        } else {
            (StatusCode::NOT_FOUND, needs_a_slash(asked.path())).into_response()
        }
    };
    let mut router = Router::new().route("/", get(first));
    for (path, kind, content) in FILES {
        router = router.route(path, get(async || (headers(kind), *content)));
    }
    for (path, kind, content) in COMPRESSED.iter().chain(MESHES) {
        let gzip = [(header::CONTENT_ENCODING, "gzip")];
        router = router.route(path, get(async move || (headers(kind), gzip, *content)));
    }
    router
}

/// Returns the error text for a page path that does not end with a slash. From such a path, a
/// browser would load the files from the wrong folder.
fn needs_a_slash(path: &str) -> String {
    format!(
        "got the path \"{path}\", expected \"{path}/\": nest the router there, since the \
        page's files are beside the page\n"
    )
}

const HTML: &str = "text/html; charset=utf-8";
static INDEX: &[u8] = include_bytes!("../page/index.html");
static OVERVIEW: &[u8] = include_bytes!("../page/overview.html");

/// Returns headers that forbid caching, so that the page and the server always have the same
/// version.
fn headers(kind: &'static str) -> [(HeaderName, &'static str); 2] {
    [
        (header::CONTENT_TYPE, kind),
        (header::CACHE_CONTROL, "no-cache"),
    ]
}

/// Path, type and content of each file.
static FILES: &[(&str, &str, &[u8])] = &[
    (
        "/dash.css",
        "text/css; charset=utf-8",
        include_bytes!("../page/dist/dash.css"),
    ),
    (
        "/icon.svg",
        "image/svg+xml",
        include_bytes!("../page/icon.svg"),
    ),
    (
        "/licenses",
        "text/plain; charset=utf-8",
        include_bytes!("../page/dist/licenses.txt"),
    ),
];

/// The same files, compressed with gzip, which every browser supports.
static COMPRESSED: &[(&str, &str, &[u8])] = &[(
    "/dash.js",
    "text/javascript; charset=utf-8",
    include_bytes!("../page/dist/dash.js.gz"),
)];

macro_rules! meshes {
    ($($name:literal)*) => {
        &[$((
            concat!("/meshes/", $name, ".glb"),
            "model/gltf-binary",
            include_bytes!(concat!("../page/meshes/", $name, ".glb.gz")),
        )),*]
    };
}

/// The shapes of the links, compressed, each in the axes of its frame. See `page/meshes/NOTICE` for
/// their source and changes.
static MESHES: &[(&str, &str, &[u8])] = meshes! {
    "hand" "finger"
    "fr3/link0" "fr3/link1" "fr3/link2" "fr3/link3" "fr3/link4" "fr3/link5" "fr3/link6" "fr3/link7"
    "fer/link0" "fer/link1" "fer/link2" "fer/link3" "fer/link4" "fer/link5" "fer/link6" "fer/link7"
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_known() {
        for (name, taken) in [
            ("ws", true),
            ("dash.js", true),
            ("meshes", true),
            ("left", false),
        ] {
            assert_eq!(is_file(name), taken, "{name}");
        }
    }

    #[test]
    fn the_page_is_small_and_brings_its_licences() {
        let files = FILES.iter().chain(COMPRESSED).chain(MESHES);
        let files = files.map(|(_, _, content)| content.len());
        let size = files.sum::<usize>() + INDEX.len() + OVERVIEW.len();
        println!("{size} bytes");
        assert!(size < 1_250_000, "{size} bytes");
        let (.., licences) = FILES.last().expect("files");
        let licences = std::str::from_utf8(licences).expect("text");
        for part in [
            "three.js authors",
            "Leon Sorokin",
            "Franka Robotics GmbH",
            "Apache License",
        ] {
            assert!(licences.contains(part), "{part}");
        }
    }
}
