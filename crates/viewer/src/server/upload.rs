//! Files that are dropped into the page.

use super::guard;
use super::shared::Shared;
use crate::dropped::{Dropped, Incoming, LARGEST};
use crate::message::SceneRequest;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::oneshot;

/// A browser that sends nothing for so long is given up.
const PATIENCE: Duration = Duration::from_secs(20);

/// Takes a file, and opens it in the place of the scene.
pub(super) async fn open(
    State(shared): State<Arc<Shared>>,
    Path(name): Path<String>,
    headers: HeaderMap,
    body: Body,
) -> Response {
    match take(&shared, &name, &headers, body).await {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err((status, message)) => (status, message + "\n").into_response(),
    }
}

async fn take(
    shared: &Shared,
    name: &str,
    headers: &HeaderMap,
    body: Body,
) -> Result<(), (StatusCode, String)> {
    let refused = |status: StatusCode| move |message: String| (status, message);
    if !guard::is_same_origin(headers) {
        return Err((StatusCode::FORBIDDEN, "pages of other origins may not open files".to_owned()));
    }
    if !shared.may_drop {
        let message = "this viewer opens no other files: start it with --edit, and without --sandbox";
        return Err((StatusCode::FORBIDDEN, message.to_owned()));
    }
    let said = headers.get(header::CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse().ok());
    if said.is_some_and(|length: u64| length > LARGEST) {
        let message = format!("files of more than {} MiB are not taken", LARGEST >> 20);
        return Err((StatusCode::PAYLOAD_TOO_LARGE, message));
    }
    let Ok(_alone) = shared.opening.try_lock() else {
        let message = "another file is being opened: try again in a moment";
        return Err((StatusCode::SERVICE_UNAVAILABLE, message.to_owned()));
    };
    let mut incoming = Incoming::named(name).map_err(refused(StatusCode::UNSUPPORTED_MEDIA_TYPE))?;
    let mut pieces = body.into_data_stream();
    let lost = || (StatusCode::BAD_REQUEST, "the file has not come as a whole: drop it in again".to_owned());
    while let Some(piece) = tokio::time::timeout(PATIENCE, pieces.next()).await.map_err(|_| lost())? {
        let piece = piece.map_err(|_| lost())?;
        incoming.add(&piece).map_err(refused(StatusCode::PAYLOAD_TOO_LARGE))?;
    }
    let (to, opened) = oneshot::channel();
    let request = SceneRequest::Open(Dropped { file: incoming.whole(), to });
    shared.open.post(request, None).map_err(refused(StatusCode::SERVICE_UNAVAILABLE))?;
    match opened.await {
        Ok(opened) => opened.map_err(refused(StatusCode::UNPROCESSABLE_ENTITY)),
        Err(_) => Err((StatusCode::SERVICE_UNAVAILABLE, "the viewer is closing".to_owned())),
    }
}
