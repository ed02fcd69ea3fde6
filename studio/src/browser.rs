//! The studio inside a page of a browser, without a server: a worker calls these functions.
//!
//! The file [`REQUEST`] holds a request as JSON. Events are lines of the standard output: the kind,
//! a tab, and the data as JSON. A worker hears nothing while it computes: a search pauses once
//! there is a file [`PAUSE`].

use crate::{
    catalogue::Catalogue,
    event::{Event, Kind, locked},
    full_analysis::{FullAnalysis, Listener, refusal},
    request::Request,
    session::{Fetched, Next, Session},
};
use anyhow::{Context, Result};
use app::failure::message;
use std::{
    cell::RefCell,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};
use support::regular_file;

const REQUEST: &str = "request.json";
const PAUSE: &str = "pause";

unsafe extern "C" {
    /// Opens the folder of all files. A module that calls it is one that stays.
    fn __wasm_call_ctors();
}

thread_local! {
    static STUDIO: RefCell<Option<Studio>> = const { RefCell::new(None) };
}

struct Studio {
    session: Session,
    files: Fetched,
    stop_search: Arc<AtomicBool>,
}

/// Opens the studio without a sheet, and says what a sheet can be made of.
#[unsafe(no_mangle)]
extern "C" fn start() {
    // SAFETY: the constructors of the C library run once, before anything else.
    unsafe { __wasm_call_ctors() };
    match Studio::new() {
        Ok(studio) => STUDIO.set(Some(studio)),
        Err(error) => print(&refusal(&message(&error))),
    }
}

/// Answers the request in [`REQUEST`].
#[unsafe(no_mangle)]
extern "C" fn answer() {
    with(|studio| match read() {
        Ok(request) => {
            studio.stop_search.store(false, Ordering::Relaxed);
            studio.session.go(Next::Request(request));
        }
        Err(error) => print(&refusal(&message(&error))),
    });
}

/// Computes the full analysis of a sheet that has not changed for a moment.
#[unsafe(no_mangle)]
extern "C" fn rest() {
    with(|studio| {
        if !studio.session.is_at_rest() {
            studio.session.go(Next::Rest);
        }
    });
}

/// Prints the paths of the files of the run, as an event of the kind `paths`.
#[unsafe(no_mangle)]
extern "C" fn paths() {
    with(|studio| {
        let json = serde_json::to_string(&*locked(&studio.files))
            .expect("paths of this program are UTF-8");
        println!("paths\t{json}");
    });
}

fn with(work: impl FnOnce(&mut Studio)) {
    STUDIO.with_borrow_mut(|studio| studio.as_mut().map(work));
}

fn read() -> Result<Request> {
    let json = regular_file::read(REQUEST.as_ref()).context("cannot read the request")?;
    Ok(serde_json::from_slice(&json)?)
}

fn print(event: &Event) {
    let kind: &str = event.kind.into();
    // The JSON of an event has no line break.
    println!("{kind}\t{}", event.data);
}

impl Studio {
    fn new() -> Result<Self> {
        let stop_search = Arc::<AtomicBool>::default();
        let listener: Listener = Arc::new({
            let stop = Arc::clone(&stop_search);
            move |event| {
                print(&event);
                if event.kind == Kind::Step && Path::new(PAUSE).exists() {
                    stop.store(true, Ordering::Relaxed);
                }
            }
        });
        listener(Event::new(Kind::Shop, &Catalogue::open()?));
        let analysis = FullAnalysis::start(Arc::clone(&listener))?;
        let files = Fetched::default();
        let session = Session::new(
            PathBuf::from("runs/studio"),
            analysis,
            Arc::clone(&stop_search),
            Arc::clone(&files),
            listener,
        );
        Ok(Self { session, files, stop_search })
    }
}
