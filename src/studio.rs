//! `kirigami studio`: a scene in the browser, designed while one looks.
//!
//! [`engine`] holds a scene, answers every [`Request`](request::Request) by
//! [`Event`](event::Event)s, and knows nothing of browsers. [`server`] carries both between the
//! engine and the pages; `browser` carries them inside a page, without a server. Everything that a
//! page shows is a scene on disk ([`project`]) that `kirigami design` repeats.

#[cfg(target_family = "wasm")]
mod browser;
mod draft;
#[cfg(unix)]
pub(crate) mod engine;
pub(crate) mod event;
mod everyday;
mod for_service;
#[cfg(unix)]
mod http;
mod key_meanings;
#[cfg(unix)]
mod page;
mod panels;
pub(crate) mod project;
pub(crate) mod request;
mod run_listing;
#[cfg(unix)]
pub(crate) mod server;
mod session;
mod shop;
#[cfg(unix)]
pub(crate) mod static_page;
