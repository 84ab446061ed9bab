//! The server: a page, its files, and a WebSocket for each browser that shows it.

mod client;
mod guard;
mod page;
mod shared;
mod upload;

use crate::ViewerError;
use crate::catalogue::catalogue;
use crate::common::Common;
use crate::message::{LONGEST, Question, Request};
use crate::open_scene::{Keeper, OpenScene};
use crate::options::Options;
use crate::threads::start;
use crate::visitors::Visitors;
use crate::watch;
use axum::Router;
use axum::extract::{State, WebSocketUpgrade};
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::serve::ListenerExt;
use bilux::watch::Watched;
use guard::Guard;
use shared::Shared;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::mpsc::RecvError;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

/// Interval at which the server looks whether it is to end.
const LOOKS: Duration = Duration::from_millis(50);

/// Time that the server waits for its threads in the end. Some work cannot be stopped in the middle; nothing is lost with it.
const PATIENCE: Duration = Duration::from_secs(1);

/// A viewer that listens, and renders as soon as somebody watches.
pub struct Server {
    listener: TcpListener,
    guard: Guard,
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Opens the scene, and listens.
    ///
    /// # Errors
    /// If the scene cannot be opened or rendered, or the system does not let it listen.
    pub fn start(options: Options) -> Result<Server, ViewerError> {
        let (listener, address) = listen(options.address)?;
        let guard = Guard::of(address)?;
        let (open, watched) = (Arc::new(OpenScene::default()), Arc::new(Watched::default()));
        let common = Arc::new(Common::new(&options, open.clone()));
        let may_drop = common.may_drop;
        let visitors = Arc::new(Visitors::new(common, options.shared, options.visitors));
        let (catalogue, opening) = (catalogue().to_string(), tokio::sync::Mutex::default());
        let shared = Shared { open: open.clone(), visitors, catalogue, may_drop, opening };
        let (opened, is_open) = std::sync::mpsc::channel();
        let (kept, files) = (open.clone(), watched.clone());
        // Not everything that renders can pass from one thread to another.
        let keep = start("scene", move || match Keeper::new(options, kept, files) {
            Ok(keeper) => {
                drop(opened.send(Ok(())));
                keeper.run();
            }
            Err(error) => drop(opened.send(Err(error))),
        })?;
        let failed = |_: RecvError| {
            Err(ViewerError::Start("opening the scene has failed: please report this".to_owned()))
        };
        is_open.recv().unwrap_or_else(failed)?;
        let watch = start("watch", move || watch::watch(&watched, &open))?;
        Ok(Server { listener, guard, shared: Arc::new(shared), threads: vec![keep, watch] })
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
        let Server { listener, guard, shared, mut threads } = self;
        let (open, visitors) = (shared.open.clone(), shared.visitors.clone());
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?.tap_io(|stream| {
                // A small frame must not wait for the next one. Without it everything works, only later.
                let _ = stream.set_nodelay(true);
            });
            let over = async {
                while !is_over() {
                    visitors.forget();
                    tokio::time::sleep(LOOKS).await;
                }
            };
            tokio::select! {
                served = axum::serve(listener, router(guard, shared)) => served,
                () = over => Ok(()),
            }
        });
        open.end();
        threads.extend(visitors.end());
        // Connections end with the runtime.
        drop(runtime);
        let asked = Instant::now();
        while threads.iter().any(|thread| !thread.is_finished()) && asked.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(5));
        }
        served.map_err(failed)
    }
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
        .route(&format!("{prefix}/picture.png"), get(|shared, uri| save(shared, uri, "png")))
        .route(&format!("{prefix}/picture.exr"), get(|shared, uri| save(shared, uri, "exr")))
        .route(&format!("{prefix}/overlay.toml"), get(overlay))
        .route(&format!("{prefix}/open/{{name}}"), post(upload::open))
        .with_state(shared);
    guard.around(files)
}

/// Connects a browser.
async fn socket(
    State(shared): State<Arc<Shared>>,
    uri: Uri,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !guard::is_same_origin(&headers) {
        return (StatusCode::FORBIDDEN, "pages of other origins may not connect\n").into_response();
    }
    let upgrade = upgrade.max_message_size(LONGEST).max_frame_size(LONGEST);
    match shared.visitors.enter(visitor(&uri)) {
        Ok(connection) => {
            upgrade.on_upgrade(|socket| async move { client::serve(socket, &shared, &connection).await })
        }
        // Pages cannot read why a connection is refused: it is accepted, and they are told.
        Err(message) => upgrade.on_upgrade(|socket| client::turn_away(socket, message)),
    }
}

/// The key of a visitor in an address, if there is one.
fn visitor(uri: &Uri) -> Option<&str> {
    uri.query()?.split('&').find_map(|part| part.strip_prefix("visitor="))
}

fn unavailable(message: String) -> Response {
    (StatusCode::SERVICE_UNAVAILABLE, message + "\n").into_response()
}

fn closing() -> Response {
    unavailable("the viewer is closing".to_owned())
}

/// Asks the view of a visitor something.
fn ask(shared: &Shared, uri: &Uri, question: Question) -> Result<(), Response> {
    let view = shared.visitors.view(visitor(uri)).map_err(unavailable)?;
    view.inbox.post(Request::Ask(question)).map_err(unavailable)
}

/// The scene with its edits as a file to keep.
async fn overlay(State(shared): State<Arc<Shared>>, uri: Uri) -> Response {
    let (to, saved) = oneshot::channel();
    if let Err(refused) = ask(&shared, &uri, Question::Overlay { to }) {
        return refused;
    }
    let headers = [
        (header::CONTENT_TYPE, "application/toml"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"edited.toml\""),
    ];
    saved.await.map_or_else(|_| closing(), |text| (headers, text).into_response())
}

/// The picture as a file to keep.
async fn save(State(shared): State<Arc<Shared>>, uri: Uri, format: &'static str) -> Response {
    let (to, saved) = oneshot::channel();
    if let Err(refused) = ask(&shared, &uri, Question::Save { format, to }) {
        return refused;
    }
    match saved.await {
        Ok(Ok(bytes)) => {
            let name = format!("attachment; filename=\"picture.{format}\"");
            let kind = if format == "png" { "image/png" } else { "image/x-exr" };
            ([(header::CONTENT_TYPE, kind.to_owned()), (header::CONTENT_DISPOSITION, name)], bytes)
                .into_response()
        }
        Ok(Err(message)) => (StatusCode::INTERNAL_SERVER_ERROR, message + "\n").into_response(),
        Err(_) => closing(),
    }
}
