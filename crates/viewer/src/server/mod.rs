//! The server: a page, its files, and a WebSocket for each browser that shows it.

mod client;
mod guard;
mod page;
mod upload;

use crate::ViewerError;
use crate::catalogue::catalogue;
use crate::inbox::Inbox;
use crate::message::{LONGEST, Question, Request};
use crate::options::Options;
use crate::stage::{Outlets, Stage};
use crate::watch;
use axum::Router;
use axum::extract::{State, WebSocketUpgrade};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::serve::ListenerExt;
use bilux::watch::Watched;
use guard::Guard;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::RecvError;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

/// The maximum number of browsers that watch at the same time.
const CLIENTS: usize = 64;

/// How often the server looks whether it is to end.
const LOOKS: Duration = Duration::from_millis(50);

/// How long it waits for its threads in the end. Some work cannot be stopped in the middle; nothing is lost with it.
const PATIENCE: Duration = Duration::from_secs(1);

/// A viewer that listens, and renders as soon as somebody watches.
pub struct Server {
    listener: TcpListener,
    guard: Guard,
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

/// What all connections share.
struct Shared {
    inbox: Arc<Inbox>,
    outlets: Arc<Outlets>,
    clients: AtomicUsize,
    catalogue: String,
    /// Whether files may be dropped in.
    may_drop: bool,
}

impl Server {
    /// Opens the scene, and listens.
    ///
    /// # Errors
    /// If the scene cannot be opened or rendered, or the system does not let it listen.
    pub fn start(options: Options) -> Result<Server, ViewerError> {
        let (listener, address) = listen(options.address)?;
        let guard = Guard::of(address)?;
        let (inbox, watched) = (Arc::new(Inbox::default()), Arc::new(Watched::default()));
        let outlets = Arc::new(Outlets::default());
        let shared = Shared {
            inbox: inbox.clone(),
            outlets: outlets.clone(),
            clients: AtomicUsize::new(0),
            catalogue: catalogue().to_string(),
            may_drop: options.may_edit && options.may_drop,
        };
        let (opened, is_open) = std::sync::mpsc::channel();
        let (mail, files) = (inbox.clone(), watched.clone());
        // Not everything that renders can pass from one thread to another.
        let render = start("render", move || match Stage::new(options, mail, outlets, files) {
            Ok(stage) => {
                drop(opened.send(Ok(())));
                stage.run();
            }
            Err(error) => drop(opened.send(Err(error))),
        })?;
        let failed =
            |_: RecvError| Err(ViewerError::Start("the render has failed: please report this".to_owned()));
        is_open.recv().unwrap_or_else(failed)?;
        let watch = start("watch", move || watch::watch(&watched, &inbox))?;
        Ok(Server { listener, guard, shared: Arc::new(shared), threads: vec![render, watch] })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        self.guard.address()
    }

    /// Serves until `is_over` says that it is to end.
    ///
    /// # Errors
    /// If the system has no sockets or threads for it.
    pub fn run(self, is_over: impl Fn() -> bool) -> Result<(), ViewerError> {
        let failed = |error: io::Error| ViewerError::Start(error.to_string());
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let Server { listener, guard, shared, threads } = self;
        let inbox = shared.inbox.clone();
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?.tap_io(|stream| {
                // A small frame must not wait for the next one. Without it everything works, only later.
                let _ = stream.set_nodelay(true);
            });
            let over = async {
                while !is_over() {
                    tokio::time::sleep(LOOKS).await;
                }
            };
            tokio::select! {
                served = axum::serve(listener, router(guard, shared)) => served,
                () = over => Ok(()),
            }
        });
        inbox.end();
        // Connections end with the runtime.
        drop(runtime);
        let asked = Instant::now();
        while threads.iter().any(|thread| !thread.is_finished()) && asked.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(5));
        }
        served.map_err(failed)
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.inbox.end();
    }
}

fn start(name: &str, work: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, ViewerError> {
    let thread = std::thread::Builder::new().name(name.to_owned()).spawn(work);
    thread.map_err(|error| ViewerError::Start(error.to_string()))
}

/// Listens, and says where.
fn listen(address: SocketAddr) -> Result<(TcpListener, SocketAddr), ViewerError> {
    let wrong = |source: io::Error| match source.kind() {
        io::ErrorKind::AddrInUse => ViewerError::PortInUse { address },
        _ => ViewerError::Listen { address, source },
    };
    let listener = TcpListener::bind(address).map_err(wrong)?;
    listener.set_nonblocking(true).map_err(wrong)?;
    let address = listener.local_addr().map_err(wrong)?;
    Ok((listener, address))
}

fn router(guard: Guard, shared: Arc<Shared>) -> Router {
    let (mut files, prefix) = (Router::new(), guard.prefix());
    for file in page::FILES {
        files =
            files.route(&format!("{prefix}/{}", file.path), get(move || async move { page::respond(file) }));
    }
    let files = files
        .route(&format!("{prefix}/socket"), get(socket))
        .route(&format!("{prefix}/picture.png"), get(|shared: State<Arc<Shared>>| save(shared, "png")))
        .route(&format!("{prefix}/picture.exr"), get(|shared: State<Arc<Shared>>| save(shared, "exr")))
        .route(&format!("{prefix}/overlay.toml"), get(overlay))
        .route(&format!("{prefix}/open/{{name}}"), post(upload::open))
        .with_state(shared);
    guard.around(files)
}

/// Connects a browser.
async fn socket(
    State(shared): State<Arc<Shared>>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !guard::is_same_origin(&headers) {
        return (StatusCode::FORBIDDEN, "pages of other origins may not connect\n").into_response();
    }
    if shared.clients.fetch_add(1, Ordering::Relaxed) >= CLIENTS {
        shared.clients.fetch_sub(1, Ordering::Relaxed);
        let message = format!("{CLIENTS} browsers watch already: close one\n");
        return (StatusCode::SERVICE_UNAVAILABLE, message).into_response();
    }
    let place = Place(shared);
    let upgrade = upgrade.max_message_size(LONGEST).max_frame_size(LONGEST);
    upgrade.on_upgrade(|socket| async move { client::serve(socket, &place.0).await })
}

/// One of the places for browsers that watch, until it is dropped.
struct Place(Arc<Shared>);

impl Drop for Place {
    fn drop(&mut self) {
        self.0.clients.fetch_sub(1, Ordering::Relaxed);
    }
}

/// The scene with its edits as a file to keep.
async fn overlay(State(shared): State<Arc<Shared>>) -> Response {
    let (to, saved) = oneshot::channel();
    let failed = |message: String| (StatusCode::SERVICE_UNAVAILABLE, message + "\n").into_response();
    if let Err(message) = shared.inbox.post(Request::Ask(Question::Overlay { to })) {
        return failed(message);
    }
    let headers = [
        (header::CONTENT_TYPE, "application/toml"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"edited.toml\""),
    ];
    match saved.await {
        Ok(text) => (headers, text).into_response(),
        Err(_) => failed("the viewer is closing".to_owned()),
    }
}

/// The picture as a file to keep.
async fn save(State(shared): State<Arc<Shared>>, format: &'static str) -> Response {
    let (to, saved) = oneshot::channel();
    let failed = |status: StatusCode, message: String| (status, message + "\n").into_response();
    if let Err(message) = shared.inbox.post(Request::Ask(Question::Save { format, to })) {
        return failed(StatusCode::SERVICE_UNAVAILABLE, message);
    }
    match saved.await {
        Ok(Ok(bytes)) => {
            let name = format!("attachment; filename=\"picture.{format}\"");
            let kind = if format == "png" { "image/png" } else { "image/x-exr" };
            ([(header::CONTENT_TYPE, kind.to_owned()), (header::CONTENT_DISPOSITION, name)], bytes)
                .into_response()
        }
        Ok(Err(message)) => failed(StatusCode::INTERNAL_SERVER_ERROR, message),
        Err(_) => failed(StatusCode::SERVICE_UNAVAILABLE, "the viewer is closing".to_owned()),
    }
}
