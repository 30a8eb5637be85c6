//! The listener: one port, limited connections, HTTP/1.1 with or without TLS.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use socket2::SockRef;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio_rustls::TlsAcceptor;

use crate::guard::{Guest, Guests, Rules};

/// How long a guest may take for its head, and for a handshake.
const HEAD: Duration = Duration::from_secs(10);
/// Bytes that a head may have: the least that the library takes.
const HEAD_BYTES: usize = 8 * 1024;
/// Headers that a head may have.
const HEADERS: usize = 48;
/// Bytes of a socket that were not sent yet, at most, before the next frame waits: a queue in the system makes frames old.
const UNSENT_BYTES: u32 = 16 * 1024;

/// Serves the routes on a listener until it is dropped.
pub async fn serve(listener: TcpListener, routes: Router, rules: Arc<Rules>, tls: Option<TlsAcceptor>) {
    let guests = Guests::default();
    loop {
        let (stream, from) = match listener.accept().await {
            Ok(accepted) => accepted,
            Err(why) => {
                // Too many open files: the next moment may have one.
                tracing::warn!(%why, "a connection was not accepted");
                tokio::time::sleep(Duration::from_millis(20)).await;
                continue;
            }
        };
        // Closed at once: an answer would cost as much as the connection.
        let Some(guest) = guests.admit(from, &rules) else { continue };
        prepare(&stream);
        let (routes, tls) = (routes.clone(), tls.clone());
        tokio::spawn(async move {
            match tls {
                None => talk(stream, from, routes, guest).await,
                Some(tls) => {
                    if let Ok(Ok(stream)) = tokio::time::timeout(HEAD, tls.accept(stream)).await {
                        talk(stream, from, routes, guest).await;
                    }
                }
            }
        });
    }
}

/// Sends at once, and holds little in the system.
fn prepare(stream: &TcpStream) {
    drop(stream.set_nodelay(true));
    #[cfg(target_os = "linux")]
    drop(SockRef::from(stream).set_tcp_notsent_lowat(UNSENT_BYTES));
    #[cfg(not(target_os = "linux"))]
    drop(SockRef::from(stream).set_send_buffer_size(4 * UNSENT_BYTES as usize));
}

async fn talk<S>(stream: S, from: SocketAddr, routes: Router, guest: Guest)
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let mut server = hyper::server::conn::http1::Builder::new();
    server.timer(TokioTimer::new()).header_read_timeout(HEAD).max_buf_size(HEAD_BYTES).max_headers(HEADERS);
    let service = TowerToHyperService::new(routes);
    // A socket outlives this task: the place is taken as long as its bytes can flow.
    let held = Held { stream, _guest: guest };
    let served = server.serve_connection(TokioIo::new(held), service).with_upgrades();
    if let Err(why) = served.await {
        tracing::debug!(%from, %why, "a connection ended");
    }
}

/// A stream that keeps its guest's place.
struct Held<S> {
    stream: S,
    _guest: Guest,
}

impl<S: AsyncRead + Unpin> AsyncRead for Held<S> {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, into)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Held<S> {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write_vectored(cx, parts)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }
}
