//! The studio over HTTP on this machine: the page, requests from it, and a stream of events to it.
//!
//! | request | answer |
//! |---|---|
//! | `GET /` | the page |
//! | `GET /events` | events, as a stream (text/event-stream), beginning with the latest of every kind |
//! | `POST /request` | 204: it is answered by events; or 400 with the reason; the body is a request of the engine as JSON |
//! | `GET /files/NAME` | a file of the run |
//!
//! Others: 403 without the token, 404 for what is not there, 413 for a body that is too long, 421
//! for another host.
//!
//! Programs on this machine and pages of other servers reach a port of 127.0.0.1, too. So every
//! request needs the token of the address that is printed, and the header `Host` must name this
//! machine, at any port, as ports are forwarded: a page of another name that resolves to 127.0.0.1
//! has that name there.

use crate::{
    engine::Engine,
    event::Post,
    http::{Answer, HttpRequest},
    page::{Connection, page},
};
use anyhow::{Context, Result};
use percent_encoding::percent_decode_str;
use std::{
    io::{self, Write},
    net::{Ipv4Addr, TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};
use support::regular_file;

/// How often the flag that ends the server is read.
const POLL: Duration = Duration::from_millis(100);
/// After this time without an event a line is sent, by which a page that is gone is noticed.
const ALIVE: Duration = Duration::from_secs(10);
/// The names of this machine that no other page can have.
const NAMES: [&str; 2] = ["127.0.0.1", "localhost"];

/// A server on a port of 127.0.0.1.
pub struct StudioServer {
    listener: TcpListener,
    port: u16,
    token: String,
    post: Arc<Post>,
}

impl StudioServer {
    /// Listens on a port, or on a free one if that is 0.
    pub fn listen(port: u16, token: String, post: Arc<Post>) -> Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        let listener =
            listener.with_context(|| format!("cannot listen on port {port} of 127.0.0.1"))?;
        let port = listener.local_addr()?.port();
        Ok(Self { listener, port, token: format!("token={token}"), post })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?{}", self.port, self.token)
    }

    /// Answers until `stop` becomes true, every request on a thread of its own: one that is slow to
    /// arrive delays no other.
    pub fn serve(self: &Arc<Self>, engine: &Arc<Engine>, stop: &AtomicBool) -> Result<()> {
        let (studio, engine) = (Arc::clone(self), Arc::clone(engine));
        let thread = std::thread::Builder::new().name("server".into());
        let thread = thread.spawn(move || studio.accept(&engine));
        // It ends with the program.
        thread.context("cannot start the thread of the server")?;
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(POLL);
        }
        Ok(())
    }

    fn accept(self: &Arc<Self>, engine: &Arc<Engine>) {
        loop {
            // Too many connections are open: some of them will be closed.
            let Ok((stream, _)) = self.listener.accept() else {
                std::thread::sleep(POLL);
                continue;
            };
            let (studio, engine) = (Arc::clone(self), Arc::clone(engine));
            let thread = std::thread::Builder::new().name("request".into());
            // A page whose request has no thread says that the studio does not answer; one that is
            // gone needs no answer.
            let _ = thread.spawn(move || studio.answer(&stream, &engine));
        }
    }

    fn answer(&self, stream: &TcpStream, engine: &Engine) -> io::Result<()> {
        let Some(request) = HttpRequest::read(stream)? else {
            return Ok(());
        };
        let (path, query) = request.target.split_once('?').unwrap_or((&request.target, ""));
        let path = percent_decode_str(path).decode_utf8_lossy();
        let answer = match (&*request.method, &*path) {
            _ if !is_ours(&request.host) => self.other_host(&request.host),
            _ if query.split('&').all(|key| key != self.token) => Answer::refusal(
                403,
                "the address needs the token that `kirigami studio` has printed",
            ),
            ("GET", "/") => Answer {
                status: 200,
                kind: "text/html; charset=utf-8",
                body: page(Connection::Http).into(),
            },
            ("GET", "/events") => return send(&self.post, stream),
            ("POST", "/request") => asked(request, engine).unwrap_or_else(|refusal| refusal),
            ("GET", name) => file(engine, name.strip_prefix("/files/").unwrap_or("")),
            _ => Answer::refusal(404, "there is nothing here"),
        };
        answer.send(stream)
    }

    fn other_host(&self, host: &str) -> Answer {
        let port = self.port;
        Answer::refusal(
            421,
            &format!(
                "the studio answers at localhost and 127.0.0.1, at any port, and not at `{host}`: forward its port to your machine, as in \
                 `ssh -L {port}:127.0.0.1:{port} HOST`, and open http://localhost:{port}/ with the token that it has printed"
            ),
        )
    }
}

/// Whether a host is this machine by its own name.
fn is_ours(host: &str) -> bool {
    NAMES.contains(&host.split(':').next().unwrap_or_default())
}

/// Sends events until the page is gone.
fn send(post: &Post, mut page: &TcpStream) -> io::Result<()> {
    let head = "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n";
    page.write_all(head.as_bytes())?;
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
    }
}

/// Hands the request in a body to the engine.
fn asked(request: HttpRequest, engine: &Engine) -> Result<Answer, Answer> {
    let asked = serde_json::from_slice(&request.body()?);
    engine.ask(asked.map_err(|error| Answer::refusal(400, &error.to_string()))?);
    Ok(Answer::refusal(204, ""))
}

fn file(engine: &Engine, name: &str) -> Answer {
    let Some(path) = engine.file(name) else {
        return Answer::refusal(404, "there is no such file");
    };
    let kind = match path.extension().and_then(|kind| kind.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("pdf") => "application/pdf",
        Some("json") => "application/json",
        Some("csv" | "txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    };
    match regular_file::read(&path) {
        Ok(body) => Answer { status: 200, kind, body },
        Err(error) => Answer::refusal(404, &error.to_string()),
    }
}
