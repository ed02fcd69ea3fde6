//! Live design in the browser: `kirigami studio`, and the page without a server.
//!
//! [`engine`] holds a scene, answers every [`Request`](request::Request) by
//! [`Event`](event::Event)s, and knows nothing of browsers. [`server`] carries both between the
//! engine and the pages; `browser` carries them inside a page, without a server. Everything that a
//! page shows is a scene on disk ([`project`]) that `kirigami design` repeats.

#![cfg_attr(not(test), warn(unreachable_pub))]

#[cfg(target_family = "wasm")]
mod browser;
mod catalogue;
mod draft;
#[cfg(unix)]
pub mod engine;
pub mod event;
mod full_analysis;
#[cfg(unix)]
mod http;
mod key_meanings;
mod opened;
#[cfg(unix)]
mod page;
mod panels;
pub mod project;
pub mod request;
mod run_listing;
#[cfg(unix)]
pub mod server;
mod session;
#[cfg(unix)]
pub mod static_page;
