//! A thread that holds a scene and answers requests one after the other.
//!
//! While something is dragged every change is answered by a draft; when no request comes for a
//! moment, by the full analysis: the path followed from the flat sheet, and the report.

use crate::{
    catalogue::Catalogue,
    event::{Event, Kind, locked},
    full_analysis::{FullAnalysis, Listener},
    project::Project,
    request::Request,
    session::{Fetched, Next, Session},
};
use anyhow::{Context, Result};
use scene::Scene;
use std::{
    collections::VecDeque,
    path::PathBuf,
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::JoinHandle,
    time::Duration,
};

/// Time without a request after which the full analysis is computed.
const REST: Duration = Duration::from_millis(200);

/// The engine.
pub struct Engine {
    inbox: Arc<Inbox>,
    stop_search: Arc<AtomicBool>,
    thread: Mutex<Option<JoinHandle<()>>>,
    files: Fetched,
}

/// Requests that wait.
#[derive(Default)]
struct Inbox {
    waiting: Mutex<Waiting>,
    news: Condvar,
}

#[derive(Default)]
struct Waiting {
    requests: VecDeque<Request>,
    /// Whether a search is under way.
    searching: bool,
    closed: bool,
}

impl Engine {
    /// Starts with a scene, or without one until a new sheet is asked for; new sheets are in
    /// folders below `projects`.
    pub fn start(
        opened: Option<(Project, Scene)>,
        projects: PathBuf,
        listener: Listener,
    ) -> Result<Self> {
        let inbox = Arc::new(Inbox::default());
        let files = Fetched::default();
        let catalogue = Catalogue::open()?;
        let stop_search = Arc::<AtomicBool>::default();
        let analysis =
            FullAnalysis::start(Arc::clone(&listener)).context("cannot start a thread")?;
        let thread = std::thread::Builder::new().name("studio".into());
        let thread = thread.spawn({
            let (inbox, files) = (Arc::clone(&inbox), Arc::clone(&files));
            let stop = Arc::clone(&stop_search);
            move || {
                listener(Event::new(Kind::Shop, &catalogue));
                let mut session = Session::new(projects, analysis, stop, files, listener);
                if let Some((project, scene)) = opened {
                    session.open(project, scene);
                }
                work(&inbox, &mut session);
            }
        });
        let thread = thread.context("cannot start the thread of the studio")?;
        Ok(Self { inbox, stop_search, thread: Mutex::new(Some(thread)), files })
    }

    /// The file that the event of the files of a run names so.
    pub fn file(&self, name: &str) -> Option<PathBuf> {
        locked(&self.files).get(name).cloned()
    }

    /// Queues a request. Consecutive changes are merged into the last one; at most one search is
    /// running or queued.
    pub fn ask(&self, request: Request) {
        let mut waiting = locked(&self.inbox.waiting);
        match &request {
            Request::Pause => return self.stop_search.store(true, Ordering::Relaxed),
            Request::Design => {
                let is_search = |request: &Request| matches!(request, Request::Design);
                if waiting.closed || waiting.searching || waiting.requests.iter().any(is_search) {
                    return;
                }
                self.stop_search.store(false, Ordering::Relaxed);
            }
            Request::Change(_) | Request::Crop { .. } => {
                let kind = std::mem::discriminant(&request);
                waiting.requests.pop_back_if(|last| std::mem::discriminant(last) == kind);
            }
            _ => {}
        }
        waiting.requests.push_back(request);
        drop(waiting);
        self.inbox.news.notify_one();
    }

    /// Answers no further request, pauses a search, and waits until its state and the scene are on
    /// disk.
    pub fn end(&self) {
        locked(&self.inbox.waiting).closed = true;
        self.stop_search.store(true, Ordering::Relaxed);
        self.inbox.news.notify_one();
        if let Some(thread) = locked(&self.thread).take() {
            let _ = thread.join();
        }
    }
}

impl Inbox {
    /// The next request, or a rest if there is none for a while and the sheet is not at rest.
    fn next(&self, at_rest: bool) -> Next {
        let mut waiting = locked(&self.waiting);
        waiting.searching = false;
        let idle = |waiting: &mut Waiting| waiting.requests.is_empty() && !waiting.closed;
        let mut waiting = if at_rest {
            (self.news.wait_while(waiting, idle)).unwrap_or_else(PoisonError::into_inner)
        } else {
            let waited = self.news.wait_timeout_while(waiting, REST, idle);
            waited.unwrap_or_else(PoisonError::into_inner).0
        };
        if waiting.closed {
            return Next::Closed;
        }
        let request = waiting.requests.pop_front();
        waiting.searching = matches!(request, Some(Request::Design));
        request.map_or(Next::Rest, Next::Request)
    }
}

/// Answers requests until the engine ends.
fn work(inbox: &Inbox, session: &mut Session) {
    loop {
        let next = inbox.next(session.is_at_rest());
        let last = matches!(next, Next::Closed);
        session.go(next);
        if last {
            return;
        }
    }
}
