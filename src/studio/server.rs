//! The studio over HTTP on this machine: the page, requests from it, and a stream of events to it.
//!
//! | request | answer |
//! |---|---|
//! | `GET /` | the page |
//! | `GET /events` | events, as a stream (text/event-stream), beginning with the latest of every kind |
//! | `POST /request` | 204: it is answered by events; or 400 with the reason; the body is a [`Request`] as JSON |
//! | `GET /files/NAME` | a file of the run |
//!
//! Others: 403 without the token, 404 for what is not there, 413 for a body that is too long, 421 for another host.
//!
//! Programs on this machine and pages of other servers reach a port of 127.0.0.1, too. So every request needs the token of the
//! address that is printed, and the header `Host` must name this server: a page of another name that resolves to 127.0.0.1 has
//! that name there.

use crate::studio::engine::Engine;
use crate::studio::event::Post;
use crate::studio::page::{Connection, page};
use crate::studio::request::Request;
use anyhow::{Result, anyhow};
use percent_encoding::percent_decode_str;
use std::io::{self, Read, Write};
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use support::regular_file;
use tiny_http::{Method, Request as Http, Server};

/// Maximum size of the body of a request (bytes): a drawing, or a scene with 100 000 panels.
const MOST_BYTES: usize = 16 << 20;
/// Announced length of a body (bytes) beyond which its connection is left alone.
const MOST_LENGTH: usize = 1 << 30;
/// How often the flag that ends the server is read.
const POLL: Duration = Duration::from_millis(100);
/// After this time without an event a line is sent, by which a page that is gone is noticed.
const ALIVE: Duration = Duration::from_secs(10);

/// A server on a port of 127.0.0.1.
pub(crate) struct Studio {
    server: Server,
    host: String,
    token: String,
    post: Arc<Post>,
}

impl Studio {
    /// Listens on a port, or on a free one if that is 0.
    pub fn listen(port: u16, token: String, post: Arc<Post>) -> Result<Self> {
        let server = Server::http((Ipv4Addr::LOCALHOST, port));
        let server = server
            .map_err(|error| anyhow!("cannot listen on port {port} of 127.0.0.1: {error}"))?;
        let host = server.server_addr().to_string();
        Ok(Self {
            server,
            host,
            token,
            post,
        })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://{}/?token={}", self.host, self.token)
    }

    /// Answers until `stop` becomes true, every request on a thread of its own: one that is slow to arrive delays no other.
    pub fn serve(self: &Arc<Self>, engine: &Arc<Engine>, stop: &AtomicBool) -> Result<()> {
        while !stop.load(Ordering::Relaxed) {
            let Some(request) = self.server.recv_timeout(POLL)? else {
                continue;
            };
            let (studio, engine) = (Arc::clone(self), Arc::clone(engine));
            let thread = std::thread::Builder::new().name("request".into());
            // A page whose request has no thread says that the studio does not answer.
            let _ = thread.spawn(move || studio.answer(request, &engine));
        }
        Ok(())
    }

    fn answer(&self, mut request: Http, engine: &Engine) {
        if request.body_length() > Some(MOST_LENGTH) {
            // The library reads a body to its end before it goes, into a buffer of this length.
            return std::mem::forget(request);
        }
        let url = request.url().to_owned();
        let (path, query) = url.split_once('?').unwrap_or((&url, ""));
        let path = percent_decode_str(path).decode_utf8_lossy();
        let answer = match (request.method(), &*path) {
            _ if !self.is_ours(&request) => refusal(421, "this server is another host"),
            _ if query != format!("token={}", self.token) => refusal(
                403,
                "the address needs the token that `kirigami studio` has printed",
            ),
            (Method::Get, "/") => Answer {
                status: 200,
                kind: "text/html; charset=utf-8",
                body: page(Connection::Http).into(),
            },
            (Method::Get, "/events") => {
                // The page is gone when it cannot be written to.
                let _ = send(&self.post, &mut *request.into_writer());
                return;
            }
            (Method::Post, "/request") => match read(&mut request) {
                Ok(asked) => {
                    engine.ask(asked);
                    Answer {
                        status: 204,
                        kind: TEXT,
                        body: Vec::new(),
                    }
                }
                Err(refusal) => refusal,
            },
            (Method::Get, name) => file(engine, name.strip_prefix("/files/").unwrap_or("")),
            _ => refusal(404, "there is nothing here"),
        };
        // A page that is gone needs no answer.
        let _ = answer.send(request);
    }

    fn is_ours(&self, request: &Http) -> bool {
        let mut hosts = request
            .headers()
            .iter()
            .filter(|header| header.field.equiv("Host"));
        let port = self.host.rsplit(':').next().unwrap_or_default();
        let local = format!("localhost:{port}");
        hosts
            .next()
            .is_some_and(|host| host.value == self.host.as_str() || host.value == local.as_str())
    }
}

/// Sends events until the page is gone.
fn send(post: &Post, page: &mut dyn Write) -> io::Result<()> {
    let head = "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n";
    page.write_all(head.as_bytes())?;
    page.flush()?;
    let mut seen = 0;
    loop {
        let events = post.since(seen, ALIVE);
        if events.is_empty() {
            page.write_all(b":\n\n")?;
        }
        for (number, event) in events {
            let kind: &str = event.kind.into();
            // The JSON of an event has no line break.
            write!(page, "event: {kind}\ndata: {}\n\n", event.data)?;
            seen = number;
        }
        page.flush()?;
    }
}

/// The request in a body.
fn read(request: &mut Http) -> Result<Request, Answer> {
    let mut body = Vec::new();
    let most = MOST_BYTES as u64;
    let long = request
        .body_length()
        .is_some_and(|length| length > MOST_BYTES);
    let read = request.as_reader().take(most + 1).read_to_end(&mut body);
    if long || body.len() > MOST_BYTES {
        let message = format!(
            "this is larger than {} MB: simplify the drawing",
            MOST_BYTES >> 20
        );
        return Err(refusal(413, &message));
    }
    read.map_err(|error| refusal(400, &error.to_string()))?;
    serde_json::from_slice(&body).map_err(|error| refusal(400, &error.to_string()))
}

/// The answer to a request.
struct Answer {
    status: u16,
    /// Its media type.
    kind: &'static str,
    body: Vec<u8>,
}

const TEXT: &str = "text/plain; charset=utf-8";

impl Answer {
    /// Answers, and closes the connection: the library may let a new connection wait for a thread that an open one keeps.
    fn send(self, request: Http) -> io::Result<()> {
        let Self { status, kind, body } = self;
        let length = body.len();
        let head = format!(
            "HTTP/1.1 {status} \r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
        );
        let mut page = request.into_writer();
        page.write_all(head.as_bytes())?;
        page.write_all(&body)?;
        page.flush()
    }
}

fn refusal(status: u16, message: &str) -> Answer {
    Answer {
        status,
        kind: TEXT,
        body: message.into(),
    }
}

fn file(engine: &Engine, name: &str) -> Answer {
    let Some(path) = engine.file(name) else {
        return refusal(404, "there is no such file");
    };
    let kind = match path.extension().and_then(|kind| kind.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("pdf") => "application/pdf",
        Some("json") => "application/json",
        Some("csv" | "txt") => TEXT,
        _ => "application/octet-stream",
    };
    match regular_file::read(&path) {
        Ok(body) => Answer {
            status: 200,
            kind,
            body,
        },
        Err(error) => refusal(404, &error.to_string()),
    }
}
