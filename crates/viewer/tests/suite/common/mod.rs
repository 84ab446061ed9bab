//! A viewer to test, and a client that speaks with it as a browser does.

#![allow(dead_code, reason = "each test uses a part of it")]

use bilux::scene::{Parameters, SceneBuilder, Spec, Value};
use bilux_viewer::{Options, Server};
use futures_util::{SinkExt, StreamExt};
use serde_json::{Value as Json, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream};

/// Time that a test waits for anything.
pub(crate) const LONG: Duration = Duration::from_secs(300);

/// A viewer that runs until it is dropped.
pub(crate) struct Viewer {
    /// The address of its page.
    pub(crate) address: String,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Viewer {
    /// A viewer of the box of Cornell, in a small size.
    pub(crate) fn start() -> Viewer {
        Viewer::with(options(cornell))
    }

    pub(crate) fn with(options: Options) -> Viewer {
        let server = Server::start(options).unwrap();
        let address = server.address();
        let over = Arc::new(AtomicBool::new(false));
        let is_over = over.clone();
        let thread = std::thread::spawn(move || server.run(|| is_over.load(Ordering::Relaxed)).unwrap());
        Viewer { address, over, thread: Some(thread) }
    }

    /// `127.0.0.1:PORT`.
    pub(crate) fn host(&self) -> &str {
        self.address.strip_prefix("http://").unwrap().split('/').next().unwrap()
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

pub(crate) fn cornell() -> Result<SceneBuilder, String> {
    bilux::generate(&Spec::new("", "cornell")).map_err(|error| error.to_string())
}

/// A viewer of a scene, 48 x 40 pixels with 16 samples by path tracing, which are not denoised.
pub(crate) fn options(open: impl Fn() -> Result<SceneBuilder, String> + Send + 'static) -> Options {
    let mut settings = Parameters::default();
    settings.set("size", "48x40");
    settings.set("spp", Value::Integer(16));
    settings.set("integrator", "path");
    settings.set("denoise", "off");
    Options {
        address: "127.0.0.1:0".parse().unwrap(),
        title: "cornell".to_owned(),
        shared: false,
        visitors: 64,
        sandboxed: false,
        environments: Vec::new(),
        may_edit: false,
        may_drop: false,
        settings,
        max_memory: 1 << 30,
        command: ["bilux", "render", "cornell.toml"].map(str::to_owned).to_vec(),
        open: Box::new(move |_| open()),
    }
}

/// Runs a test within [`LONG`].
pub(crate) fn run<T>(test: impl Future<Output = T>) -> T {
    run_for(LONG, test)
}

/// Runs a test within another time.
pub(crate) fn run_for<T>(time: Duration, test: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async { tokio::time::timeout(time, test).await.expect("it takes too long") })
}

/// A frame as it came.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) header: Json,
    pub(crate) bytes: Vec<u8>,
}

impl Frame {
    pub(crate) fn number(&self, key: &str) -> u64 {
        self.header[key].as_u64().unwrap()
    }

    pub(crate) fn rests(&self) -> bool {
        self.header["rests"] == true
    }
}

/// Message of a viewer.
#[derive(Clone, Debug)]
pub(crate) enum Said {
    Frame(Frame),
    Text(Json),
}

/// A browser.
pub(crate) struct Client {
    /// By which the viewer knows its visitor; empty if there is no place.
    pub(crate) key: String,
    socket: WebSocketStream<MaybeTlsStream<TcpStream>>,
    /// Why there is no place for it.
    pub(crate) refused: Option<String>,
    /// Whether it says that it has seen frames.
    pub(crate) sees: bool,
}

impl Client {
    pub(crate) async fn connect(viewer: &Viewer) -> Client {
        Client::connect_as(viewer, &[]).await.unwrap()
    }

    /// Connects with these headers, which replace those that a client sends by itself.
    pub(crate) async fn connect_as(
        viewer: &Viewer,
        headers: &[(&'static str, &str)],
    ) -> Result<Client, Error> {
        let address = viewer.address.replacen("http", "ws", 1) + "socket";
        Client::connect_to(&address, headers).await
    }

    pub(crate) async fn connect_to(address: &str, headers: &[(&'static str, &str)]) -> Result<Client, Error> {
        let mut request = address.into_client_request()?;
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        let (socket, _) = tokio_tungstenite::connect_async(request).await?;
        let mut client = Client { key: String::new(), refused: None, socket, sees: true };
        if let Some(Said::Text(first)) = client.next().await {
            client.key = first["key"].as_str().unwrap_or_default().to_owned();
            client.refused = first["message"].as_str().map(str::to_owned);
        }
        Ok(client)
    }

    pub(crate) async fn send(&mut self, message: Json) {
        self.send_text(&message.to_string()).await.unwrap();
    }

    pub(crate) async fn send_text(&mut self, text: &str) -> Result<(), Error> {
        self.socket.send(Message::text(text)).await
    }

    pub(crate) async fn send_bytes(&mut self, bytes: Vec<u8>) -> Result<(), Error> {
        self.socket.send(Message::binary(bytes)).await
    }

    /// The next thing that the viewer says; `None` when it has closed the connection.
    pub(crate) async fn next(&mut self) -> Option<Said> {
        loop {
            match self.socket.next().await?.ok()? {
                Message::Text(text) => return Some(Said::Text(serde_json::from_str(&text).unwrap())),
                Message::Binary(bytes) => {
                    let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
                    let header: Json = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
                    if self.sees {
                        self.send(json!({ "do": "seen", "frame": header["frame"] })).await;
                    }
                    return Some(Said::Frame(Frame { header, bytes: bytes[4 + length..].to_vec() }));
                }
                Message::Close(_) => return None,
                _ => {}
            }
        }
    }

    /// The next frame of which this holds.
    pub(crate) async fn frame(&mut self, is_wanted: impl Fn(&Frame) -> bool) -> Frame {
        loop {
            match self.next().await.expect("the viewer has closed the connection") {
                Said::Frame(frame) if is_wanted(&frame) => return frame,
                _ => {}
            }
        }
    }

    /// The next message that says this and of which this holds.
    pub(crate) async fn text(&mut self, say: &str, is_wanted: impl Fn(&Json) -> bool) -> Json {
        loop {
            match self.next().await.expect("the viewer has closed the connection") {
                Said::Text(json) if json["say"] == say && is_wanted(&json) => return json,
                _ => {}
            }
        }
    }
}

/// Asks for a file by HTTP with this `Host`; the status line, the headers and the body as they came.
pub(crate) async fn get(host: &str, path: &str, named: &str, headers: &str) -> (String, Vec<u8>) {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let mut stream = TcpStream::connect(host).await.unwrap();
    let request = format!("GET {path} HTTP/1.1\r\nHost: {named}\r\n{headers}Connection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).await.unwrap();
    let end = answer.windows(4).position(|part| part == b"\r\n\r\n").expect("an answer has headers");
    (String::from_utf8_lossy(&answer[..end]).into_owned(), answer[end + 4..].to_vec())
}

/// Sends a file by HTTP; the whole answer.
pub(crate) async fn post(host: &str, path: &str, headers: &str, body: &[u8]) -> String {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let mut stream = TcpStream::connect(host).await.unwrap();
    let length = body.len();
    let head = format!(
        "POST {path} HTTP/1.1\r\nHost: {host}\r\n{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(&[head.as_bytes(), body].concat()).await.unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).await.unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}
