//! One browser: what it says goes to the inbox, and it gets the newest frame whenever it has seen the ones before.

use super::shared::Shared;
use crate::frame::Frame;
use crate::message::{Answers, Message, parse};
use crate::visitors::Connection;
use axum::extract::ws::{self, WebSocket};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use serde_json::json;
use std::time::Duration;
use tokio::sync::{mpsc, watch};

/// The number of frames that may be under way to a browser. It has to see them before it gets another one, or old frames
/// would queue up on slow connections.
const UNDER_WAY: u64 = 2;

/// The number of answers that may wait for a browser to take them.
const ANSWERS: usize = 32;

/// A browser that takes nothing for so long is given up.
const PATIENCE: Duration = Duration::from_secs(20);

/// The connection is closed.
struct Closed;

/// Serves a browser until it leaves.
pub(super) async fn serve(socket: WebSocket, shared: &Shared, connection: &Connection) {
    let view = &connection.view;
    let (sink, stream) = socket.split();
    let (answers, waiting) = mpsc::channel(ANSWERS);
    let (seen, last_seen) = watch::channel(0);
    let mut writer = Writer {
        sink,
        frames: view.outlets.frames.subscribe(),
        other: view.outlets.other.subscribe(),
        state: view.outlets.state.subscribe(),
        progress: view.outlets.progress.subscribe(),
        answers: waiting,
        seen: last_seen,
        under_way: Vec::new(),
    };
    // Somebody watches now.
    view.inbox.ring();
    let visitor = json!({ "say": "visitor", "key": view.key });
    let writes = async {
        writer.send(visitor.to_string().into()).await?;
        writer.send(shared.catalogue.clone().into()).await?;
        writer.run().await
    };
    // Whichever ends first ends the other.
    tokio::select! {
        _ = writes => {}
        () = read(stream, shared, connection, &answers, &seen) => {}
    }
}

/// Says why somebody may not come in.
pub(super) async fn turn_away(mut socket: WebSocket, message: String) {
    let full = json!({ "say": "full", "message": message }).to_string();
    // Whoever has asked may have gone.
    let _ = tokio::time::timeout(PATIENCE, socket.send(full.into())).await;
    let _ = tokio::time::timeout(PATIENCE, socket.send(ws::Message::Close(None))).await;
}

/// Takes what a browser says.
async fn read(
    mut stream: SplitStream<WebSocket>,
    shared: &Shared,
    connection: &Connection,
    answers: &Answers,
    seen: &watch::Sender<u64>,
) {
    while let Some(Ok(message)) = stream.next().await {
        let text = match message {
            ws::Message::Text(text) => text,
            ws::Message::Close(_) => return,
            ws::Message::Ping(_) | ws::Message::Pong(_) => continue,
            ws::Message::Binary(_) => "binary".into(),
        };
        let done = match parse(&text, answers) {
            Ok(Message::Seen(frame)) => {
                seen.send_replace(frame);
                Ok(())
            }
            Ok(Message::Request(request)) => connection.view.inbox.post(request),
            Ok(Message::Scene(request)) => shared.open.post(request, Some(connection.view.inbox.clone())),
            Err(error) => Err(error),
        };
        if let Err(message) = done {
            // A browser that does not take its answers loses them.
            let _ = answers.try_send(json!({ "say": "error", "message": message }).to_string());
        }
    }
}

/// Sends to a browser.
struct Writer {
    sink: SplitSink<WebSocket, ws::Message>,
    frames: watch::Receiver<Option<std::sync::Arc<Frame>>>,
    other: watch::Receiver<Option<std::sync::Arc<Frame>>>,
    state: watch::Receiver<std::sync::Arc<str>>,
    progress: watch::Receiver<std::sync::Arc<str>>,
    answers: mpsc::Receiver<String>,
    seen: watch::Receiver<u64>,
    /// The frames that were sent and not seen.
    under_way: Vec<u64>,
}

impl Writer {
    async fn run(&mut self) -> Result<(), Closed> {
        self.frames.mark_changed();
        self.other.mark_changed();
        self.state.mark_changed();
        self.progress.mark_changed();
        loop {
            let is_ready = (self.under_way.len() as u64) < UNDER_WAY;
            tokio::select! {
                biased;
                answer = self.answers.recv() => {
                    self.send(answer.ok_or(Closed)?.into()).await?;
                }
                changed = self.seen.changed() => {
                    changed.map_err(|_| Closed)?;
                    let seen = *self.seen.borrow_and_update();
                    self.under_way.retain(|frame| *frame > seen);
                }
                changed = self.state.changed() => {
                    changed.map_err(|_| Closed)?;
                    self.send_state().await?;
                }
                changed = self.frames.changed(), if is_ready => {
                    changed.map_err(|_| Closed)?;
                    let frame = self.frames.borrow_and_update().clone();
                    self.send_frame(frame).await?;
                }
                changed = self.progress.changed(), if is_ready => {
                    changed.map_err(|_| Closed)?;
                    let progress = self.progress.borrow_and_update().to_string();
                    self.send_text(progress).await?;
                }
                changed = self.other.changed(), if is_ready => {
                    changed.map_err(|_| Closed)?;
                    let frame = self.other.borrow_and_update().clone();
                    self.send_frame(frame).await?;
                }
            }
        }
    }

    async fn send_state(&mut self) -> Result<(), Closed> {
        let state = self.state.borrow_and_update().to_string();
        self.send_text(state).await
    }

    /// Sends a text, if there is one: a view that has just been opened has none.
    async fn send_text(&mut self, text: String) -> Result<(), Closed> {
        if text.is_empty() { Ok(()) } else { self.send(text.into()).await }
    }

    /// Sends a frame, after the state if that was published before it.
    async fn send_frame(&mut self, frame: Option<std::sync::Arc<Frame>>) -> Result<(), Closed> {
        let Some(frame) = frame else { return Ok(()) };
        if self.state.has_changed().map_err(|_| Closed)? {
            self.send_state().await?;
        }
        self.under_way.push(frame.number);
        self.send(ws::Message::Binary(frame.message.clone())).await
    }

    async fn send(&mut self, message: ws::Message) -> Result<(), Closed> {
        match tokio::time::timeout(PATIENCE, self.sink.send(message)).await {
            Ok(Ok(())) => Ok(()),
            _ => Err(Closed),
        }
    }
}
