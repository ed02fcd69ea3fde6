//! `kirigami studio`: a scene in the browser, designed while one looks.
//!
//! [`engine`] holds a scene, answers every [`Request`](request::Request) by [`Event`](event::Event)s, and knows nothing of browsers.
//! [`server`] carries both between the engine and the pages. Everything that a page shows is a scene on disk ([`project`]) that
//! `kirigami design` repeats.

mod draft;
pub(crate) mod engine;
pub(crate) mod event;
mod everyday;
mod http;
mod key_meanings;
mod panels;
pub(crate) mod project;
pub(crate) mod request;
mod run_listing;
pub(crate) mod server;
mod session;
mod shop;
