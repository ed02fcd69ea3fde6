//! What the engine says to the pages, and the latest of every kind for pages that join late or read
//! slowly.
//!
//! An event holds all that a page needs to know of its kind, so that only the latest matters.

use serde::Serialize;
use std::{
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::Duration,
};
use strum::IntoStaticStr;

/// What an event is about.
#[derive(Clone, Copy, Debug, PartialEq, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Kind {
    /// The materials with weights, the machines, what the keys of a scene mean, and examples.
    Shop,
    /// Which sheet is open from now on; what was said of another is forgotten.
    Sheet,
    /// The keys of its scene.
    Scene,
    /// The sheet at full load, computed while something is dragged.
    Draft,
    /// The whole path, before the report is ready.
    Path,
    /// The whole path, with report and findings.
    Page,
    /// A step of the search.
    Step,
    /// What the engine is doing.
    Working,
    /// Why the last request was refused, or what it did.
    Says,
    /// What a person may expect of the sheet that was fitted to a drawing.
    Fit,
    /// The pieces of a drawing, one of which can be a sheet.
    Pieces,
    /// The panels of another side that would show a drawing.
    Crop,
    /// The cost and the accuracy of the levels of a sheet.
    Levels,
    /// The files of its run, and what services say of them.
    Files,
}

/// An event, with its data as JSON.
pub struct Event {
    /// What it is about.
    pub kind: Kind,
    /// JSON without a line break.
    pub data: String,
}

impl Event {
    /// An event with its data.
    pub fn new(kind: Kind, data: &impl Serialize) -> Self {
        let data = serde_json::to_string(data).expect("the data of events have text keys");
        Self { kind, data }
    }
}

/// Locks; what a thread that panicked has left is used.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The latest event of every kind.
#[derive(Default)]
pub struct Post {
    latest: Mutex<Latest>,
    news: Condvar,
}

#[derive(Default)]
struct Latest {
    /// Number of events so far.
    count: u64,
    /// With their numbers, in ascending order.
    events: Vec<(u64, Arc<Event>)>,
}

impl Post {
    /// Stores an event and wakes the readers.
    pub fn deliver(&self, event: Event) {
        let mut latest = locked(&self.latest);
        latest.count += 1;
        let number = latest.count;
        let opens = event.kind == Kind::Sheet;
        latest.events.retain(|(_, earlier)| match opens {
            true => earlier.kind == Kind::Shop,
            false => earlier.kind != event.kind,
        });
        latest.events.push((number, Arc::new(event)));
        drop(latest);
        self.news.notify_all();
    }

    /// The events since that with the number `seen`, as soon as there are any; none if there are
    /// none for as long as `patience`.
    pub fn since(&self, seen: u64, patience: Duration) -> Vec<(u64, Arc<Event>)> {
        let latest = locked(&self.latest);
        let waited =
            (self.news).wait_timeout_while(latest, patience, |latest| latest.count == seen);
        let (latest, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let unseen = latest.events.iter().filter(|(number, _)| *number > seen);
        unseen.cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(post: &Post, seen: u64) -> Vec<String> {
        let events = post.since(seen, Duration::ZERO);
        events.iter().map(|(_, event)| event.data.clone()).collect()
    }

    #[test]
    fn a_page_gets_the_latest_of_every_kind_in_their_order() {
        let post = Post::default();
        assert!(texts(&post, 0).is_empty());
        for i in 0..10_000 {
            post.deliver(Event::new(Kind::Draft, &i));
            if i == 5000 {
                post.deliver(Event::new(Kind::Page, &"page"));
            }
        }
        assert_eq!(texts(&post, 0), ["\"page\"", "9999"]);
        assert_eq!(texts(&post, 5002), ["9999"]);
        assert!(texts(&post, 10_001).is_empty());
    }

    #[test]
    fn what_is_said_of_a_sheet_follows_it_and_is_forgotten_with_it() {
        let post = Post::default();
        for kind in [Kind::Shop, Kind::Sheet, Kind::Scene, Kind::Page, Kind::Scene] {
            post.deliver(Event::new(kind, &<&str>::from(kind)));
        }
        let said = ["\"shop\"", "\"sheet\"", "\"page\"", "\"scene\""];
        assert_eq!(texts(&post, 0), said);
        post.deliver(Event::new(Kind::Sheet, &"other"));
        assert_eq!(texts(&post, 0), ["\"shop\"", "\"other\""]);
    }

    #[test]
    fn a_page_that_waits_is_woken() {
        let post = Arc::new(Post::default());
        let reader = Arc::clone(&post);
        let waiting = std::thread::spawn(move || reader.since(0, Duration::from_secs(60)).len());
        post.deliver(Event::new(Kind::Says, &"now"));
        assert_eq!(waiting.join().unwrap(), 1);
    }
}
