//! Visitors. Each has a view of their own, until they have been away for a while; or all have the same one.

use crate::ViewerError;
use crate::common::Common;
use crate::inbox::Inbox;
use crate::secret::secret;
use crate::stage::{Outlets, Stage};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time for which the view of a visitor is kept whose connection is lost.
const KEPT: Duration = Duration::from_secs(60);

/// A view must have room for at least so many pixels.
const LEAST_PIXELS: u64 = 320 * 240;

/// A view, and what its connections need of it.
pub(crate) struct View {
    /// By which its visitor finds it again.
    pub(crate) key: String,
    pub(crate) inbox: Arc<Inbox>,
    pub(crate) outlets: Arc<Outlets>,
}

/// The visitors.
pub(crate) struct Visitors {
    common: Arc<Common>,
    /// Whether all see the same view.
    shared: bool,
    most: usize,
    places: Mutex<Places>,
}

#[derive(Default)]
struct Places {
    all: Vec<Place>,
    threads: Vec<JoinHandle<()>>,
}

/// A view, and who sees it.
struct Place {
    view: Arc<View>,
    connections: usize,
    /// When the last connection was lost.
    left: Instant,
}

/// A connection of a visitor, until it is dropped.
pub(crate) struct Connection {
    visitors: Arc<Visitors>,
    pub(crate) view: Arc<View>,
}

impl Drop for Connection {
    fn drop(&mut self) {
        let mut places = self.visitors.lock();
        if let Some(place) = places.all.iter_mut().find(|place| Arc::ptr_eq(&place.view, &self.view)) {
            place.connections -= 1;
            place.left = Instant::now();
        }
    }
}

impl Visitors {
    /// Nobody so far, and at most so many at a time.
    pub(crate) fn new(common: Arc<Common>, shared: bool, most: usize) -> Visitors {
        Visitors { common, shared, most: most.max(1), places: Mutex::default() }
    }

    /// Lets somebody in: into the view with this key, if there still is one, or into one of their own.
    ///
    /// # Errors
    /// Why nobody else may come in; for people.
    pub(crate) fn enter(self: &Arc<Visitors>, key: Option<&str>) -> Result<Connection, String> {
        let mut places = self.lock();
        places.forget_those_who_left(KEPT);
        let connections: usize = places.all.iter().map(|place| place.connections).sum();
        if connections >= self.most {
            let most = self.most;
            return Err(format!(
                "every place of this viewer is taken ({most}): try again when somebody has left"
            ));
        }
        let is_known = |place: &&mut Place| {
            (self.shared || key == Some(&*place.view.key)) && !place.view.inbox.has_ended()
        };
        let view = match places.all.iter_mut().find(is_known) {
            Some(place) => {
                place.connections += 1;
                place.view.clone()
            }
            None => self.open(&mut places)?,
        };
        drop(places);
        Ok(Connection { visitors: self.clone(), view })
    }

    /// The view with this key; without one, the only one that there is.
    ///
    /// # Errors
    /// Why there is none; for people.
    pub(crate) fn view(&self, key: Option<&str>) -> Result<Arc<View>, String> {
        let places = self.lock();
        let is_wanted = |place: &&Place| self.shared || key.is_none_or(|key| key == place.view.key);
        let mut wanted = places.all.iter().filter(is_wanted);
        match (wanted.next(), wanted.next()) {
            (Some(place), None) => Ok(place.view.clone()),
            (None, _) => Err("nobody watches: open the page first".to_owned()),
            _ => Err("each visitor has a view of their own: use the link in the page".to_owned()),
        }
    }

    /// Ends the views of those who have been away for too long.
    pub(crate) fn forget(&self) {
        self.lock().forget_those_who_left(KEPT);
    }

    /// Opens another view.
    fn open(&self, places: &mut Places) -> Result<Arc<View>, String> {
        // Those who have left make room for those who come.
        if places.all.len() >= self.most || !self.has_room() {
            places.forget_those_who_left(Duration::ZERO);
        }
        if !self.has_room() {
            return Err(
                "there is no memory for another view of this scene: try again when somebody has left \
                        (bilux serve --shared shows all of them the same one)"
                    .to_owned(),
            );
        }
        let failed = |error: ViewerError| error.to_string();
        let key = secret().map_err(failed)?;
        let view = View { key, inbox: Arc::default(), outlets: Arc::default() };
        places.threads.push(begin(&self.common, &view).map_err(failed)?);
        let view = Arc::new(view);
        places.all.push(Place { view: view.clone(), connections: 1, left: Instant::now() });
        Ok(view)
    }

    fn has_room(&self) -> bool {
        let Some(version) = self.common.open.newest() else { return false };
        self.common.room.is_left(LEAST_PIXELS, &version.scene, self.common.max_memory)
    }

    /// Ends all views. Returns their threads.
    pub(crate) fn end(&self) -> Vec<JoinHandle<()>> {
        let mut places = self.lock();
        places.all.iter().for_each(|place| place.view.inbox.end());
        std::mem::take(&mut places.threads)
    }

    fn lock(&self) -> MutexGuard<'_, Places> {
        self.places.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Places {
    /// Ends the views of those who have been away for longer than this.
    fn forget_those_who_left(&mut self, longer: Duration) {
        self.all.retain(|place| {
            let stays = place.connections > 0 || place.left.elapsed() < longer;
            if !stays {
                place.view.inbox.end();
            }
            stays
        });
        self.threads.retain(|thread| !thread.is_finished());
    }
}

/// Begins the render of a view. Not everything that renders can pass from one thread to another.
fn begin(common: &Arc<Common>, view: &View) -> Result<JoinHandle<()>, ViewerError> {
    let (common, inbox, outlets) = (common.clone(), view.inbox.clone(), view.outlets.clone());
    let ended = inbox.clone();
    let render = move || match Stage::new(common, inbox, outlets.clone()) {
        Ok(stage) => stage.run(),
        Err(error) => {
            ended.end();
            let problem = serde_json::json!({ "say": "error", "message": error.to_string() });
            outlets.progress.send_replace(problem.to_string().into());
        }
    };
    crate::threads::start("view", render)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use crate::open_scene::{Keeper, OpenScene};
    use bilux::scene::{Parameters, Spec};

    /// Visitors of the box of Cornell in few pixels.
    fn visitors() -> Arc<Visitors> {
        let mut settings = Parameters::default();
        for (key, value) in [("size", "8x8"), ("integrator", "path"), ("denoise", "off")] {
            settings.set(key, value);
        }
        let options = Options {
            address: "127.0.0.1:0".parse().unwrap(),
            title: String::new(),
            shared: false,
            visitors: 4,
            sandboxed: false,
            environments: Vec::new(),
            may_edit: false,
            may_drop: false,
            settings,
            max_memory: 1 << 30,
            command: Vec::new(),
            open: Box::new(|_| bilux::generate(&Spec::new("", "cornell")).map_err(|error| error.to_string())),
        };
        let open = Arc::new(OpenScene::default());
        let common = Arc::new(Common::new(&options, open.clone()));
        drop(Keeper::new(options, open, Arc::default()).unwrap());
        Arc::new(Visitors::new(common, false, 4))
    }

    /// A visitor who comes back to a view whose render has failed gets one that works.
    #[test]
    fn a_view_that_has_ended_is_not_entered_again() {
        let visitors = visitors();
        let first = visitors.enter(None).unwrap();
        let key = first.view.key.clone();
        assert_eq!(visitors.enter(Some(&key)).unwrap().view.key, key, "it is kept");
        first.view.inbox.end();
        let again = visitors.enter(Some(&key)).unwrap();
        assert!(again.view.key != key && !again.view.inbox.has_ended());
        for thread in visitors.end() {
            thread.join().unwrap();
        }
    }
}
