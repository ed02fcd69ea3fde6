//! HTTP over a stream: one request, and one answer, after which the connection is closed.
//!
//! A request has a few seconds to arrive, and a page as many to read: a connection that stays
//! silent keeps no thread.

use std::{
    io::{self, Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};

/// Maximum size of the body of a request (bytes): a drawing, or a scene with 100 000 panels.
pub(crate) const MOST_BYTES: usize = 16 << 20;
/// Maximum size of what precedes it (bytes).
const MOST_HEAD: usize = 16 << 10;
/// How long a request may take to arrive, and a page to read a part of an answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// What precedes the body of a request, and a stream from which the body is read.
pub(crate) struct HttpRequest<'a> {
    pub method: String,
    /// The path with the query.
    pub target: String,
    /// The header `Host`.
    pub host: String,
    length: usize,
    body: Vec<u8>,
    rest: Arriving<'a>,
}

/// An answer that is not an event stream.
pub(crate) struct Answer {
    pub status: u16,
    /// Its media type.
    pub kind: &'static str,
    pub body: Vec<u8>,
}

/// A stream that is read until a deadline.
struct Arriving<'a> {
    stream: &'a TcpStream,
    deadline: Instant,
}

impl Read for Arriving<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = self.deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(buffer)
    }
}

impl<'a> HttpRequest<'a> {
    /// Reads what precedes the body; `None` if no request arrives in time.
    pub(crate) fn read(stream: &'a TcpStream) -> io::Result<Option<Self>> {
        stream.set_write_timeout(Some(PATIENCE))?;
        let deadline = Instant::now() + PATIENCE;
        let mut rest = Arriving { stream, deadline };
        let (mut received, mut part) = (Vec::new(), [0; 4096]);
        while received.len() < MOST_HEAD {
            let count = rest.read(&mut part)?;
            if count == 0 {
                break;
            }
            received.extend(&part[..count]);
            let mut headers = [httparse::EMPTY_HEADER; 64];
            let mut head = httparse::Request::new(&mut headers);
            let Ok(parsed) = head.parse(&received) else {
                break;
            };
            let httparse::Status::Complete(end) = parsed else {
                continue;
            };
            let header = |name: &str| {
                let mut named = head.headers.iter().filter(|it| it.name.eq_ignore_ascii_case(name));
                named
                    .next()
                    .map_or("", |it| str::from_utf8(it.value).unwrap_or_default())
                    .to_owned()
            };
            return Ok(Some(Self {
                method: head.method.unwrap_or_default().to_owned(),
                target: head.path.unwrap_or_default().to_owned(),
                host: header("Host"),
                length: header("Content-Length").parse().unwrap_or(0),
                body: received[end..].to_vec(),
                rest,
            }));
        }
        Ok(None)
    }

    /// The body; an answer if it is too long or does not arrive.
    pub(crate) fn body(self) -> Result<Vec<u8>, Answer> {
        let Self { length, mut body, rest, .. } = self;
        if length > MOST_BYTES {
            let most = MOST_BYTES >> 20;
            return Err(Answer::refusal(
                413,
                &format!("this is larger than {most} MB: simplify the drawing"),
            ));
        }
        let missing = length.saturating_sub(body.len()) as u64;
        let read = rest.take(missing).read_to_end(&mut body);
        read.map_err(|error| Answer::refusal(400, &error.to_string()))?;
        Ok(body)
    }
}

impl Answer {
    /// A text.
    pub(crate) fn refusal(status: u16, message: &str) -> Self {
        let kind = "text/plain; charset=utf-8";
        Self { status, kind, body: message.into() }
    }

    pub(crate) fn send(self, mut page: &TcpStream) -> io::Result<()> {
        let Self { status, kind, body } = self;
        let length = body.len();
        let head = format!(
            "HTTP/1.1 {status} \r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
        );
        page.write_all(head.as_bytes())?;
        page.write_all(&body)
    }
}
