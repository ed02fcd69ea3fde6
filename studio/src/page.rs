//! The page of the studio.

use output::run_page::PageContent;

/// How the page reaches the engine.
#[derive(Clone, Copy)]
pub(crate) enum Connection {
    /// Over HTTP, from the server of the page.
    Http,
    /// In a worker of the page.
    Worker,
}

/// The page as HTML.
pub(crate) fn page(connection: Connection) -> String {
    let (connections, transport) = match connection {
        Connection::Http => ("; connect-src 'self'", include_str!("page/http.js")),
        Connection::Worker => {
            ("; connect-src 'self' blob:; worker-src 'self'", include_str!("page/in_page.js"))
        }
    };
    let page = PageContent {
        title: "kirigami studio",
        connections,
        controls: include_str!("page/controls.html"),
        style: include_str!("page/studio.css"),
        scripts: [
            transport,
            include_str!("page/connection.js"),
            include_str!("page/fields.js"),
            include_str!("page/target.js"),
            include_str!("page/grips.js"),
            include_str!("page/studio.js"),
        ]
        .concat(),
        data: "null",
    };
    page.to_html()
}
