//! The documents as server-sent events (<https://html.spec.whatwg.org/multipage/server-sent-events.html>).

use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use hyper::body::{Body, Bytes, Frame};
use tokio::sync::mpsc;
use tokio::task::AbortHandle;

use super::hub::Hub;

/// Events that may wait for the connection of a client. Further ones stay in the hub, which may leave them out.
const WAITING: usize = 16;
/// Interval of the comments that keep a connection without events open.
const ALIVE: Duration = Duration::from_secs(15);

/// The body of a response that goes on as long as there are documents.
pub(super) struct Events {
    frames: mpsc::Receiver<Bytes>,
    /// Brings the documents; ends with the connection.
    pump: AbortHandle,
}

impl Drop for Events {
    fn drop(&mut self) {
        self.pump.abort();
    }
}

impl Events {
    pub(super) fn new(hub: Hub) -> Self {
        let (sender, frames) = mpsc::channel(WAITING);
        let pump = tokio::spawn(async move {
            // It ends when the client has gone.
            let _: Option<()> = pump(&hub, &sender).await;
        });
        Self { frames, pump: pump.abort_handle() }
    }
}

async fn pump(hub: &Hub, client: &mpsc::Sender<Bytes>) -> Option<()> {
    // A client that takes nothing is given up by its connection.
    let send = |text: String| async move { client.send(Bytes::from(text)).await.ok() };
    let mut changes = hub.watch();
    let (past, mut place) = hub.new_client();
    for document in past {
        send(format!("data: {document}\n\n")).await?;
    }
    loop {
        let (news, lost) = hub.since(&mut place);
        if lost > 0 {
            send(format!(": {lost} documents passed over\n\n")).await?;
        }
        for document in news {
            send(format!("data: {document}\n\n")).await?;
        }
        match tokio::time::timeout(ALIVE, changes.changed()).await {
            Ok(changed) => changed.ok()?,
            Err(_) => send(": alive\n\n".to_owned()).await?,
        }
    }
}

impl Body for Events {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.frames.poll_recv(context).map(|bytes| bytes.map(|bytes| Ok(Frame::data(bytes))))
    }
}
