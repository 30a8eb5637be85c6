//! Pages in a headless Chromium, where one is installed.

use std::path::{Path, PathBuf};

use crate::program::run;
use crate::skip;

/// Names under which the browser is installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// The browser; where there is none, the running test is left out.
#[track_caller]
pub fn chromium() -> Option<PathBuf> {
    let found = NAMES.into_iter().find_map(skip::program);
    skip::installed(found.ok_or_else(|| "there is no Chromium in PATH".to_owned()))
}

/// Opens a page in a window of this width, px, and hands back what a script finds there: the value of its last expression.
///
/// # Errors
/// When the browser cannot be run, or the script failed.
pub fn ask(browser: &Path, folder: &Path, html: &str, width: u32, script: &str) -> std::io::Result<serde_json::Value> {
    let probe = format!(
        "<script>addEventListener('load', () => {{ let found; try {{ found = (() => {{ {script} }})(); }} \
         catch (why) {{ found = {{ failed: String(why) }}; }} const answer = document.createElement('pre'); \
         answer.id = 'answer'; answer.textContent = btoa(unescape(encodeURIComponent(JSON.stringify(found)))); \
         document.body.append(answer); }});</script></body>"
    );
    let page = folder.join(format!("asked-{width}.html"));
    std::fs::write(&page, html.replacen("</body>", &probe, 1))?;
    let (profile, window, address) = (
        format!("--user-data-dir={}", folder.join("browser").display()),
        format!("--window-size={width},1400"),
        format!("file://{}", page.display()),
    );
    let args = [
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--hide-scrollbars",
        "--virtual-time-budget=1500",
        profile.as_str(),
        window.as_str(),
        "--dump-dom",
        address.as_str(),
    ];
    let finished = run(&browser.display().to_string(), &args, folder, &format!("browser-{width}"))?;
    let wrong = |what: &str| std::io::Error::other(format!("{what}\n{}", finished.err));
    let (_, rest) = finished.out.split_once("<pre id=\"answer\">").ok_or_else(|| wrong("the page did not answer"))?;
    let coded = rest.split('<').next().unwrap_or_default();
    let found: serde_json::Value = serde_json::from_slice(&decoded(coded))?;
    match found.get("failed") {
        Some(why) => Err(wrong(&format!("the script failed: {why}"))),
        None => Ok(found),
    }
}

/// The bytes of a text in base 64.
fn decoded(text: &str) -> Vec<u8> {
    const SIGNS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let (mut bytes, mut held, mut bits) = (Vec::new(), 0_u32, 0);
    for sign in text.bytes().filter_map(|byte| SIGNS.iter().position(|sign| *sign == byte)) {
        held = (held << 6) | u32::try_from(sign).unwrap_or(0);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push(u8::try_from((held >> bits) & 0xff).unwrap_or(0));
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_is_read_as_it_is_written() {
        assert_eq!(decoded("aGVsbG8="), b"hello");
        assert_eq!(decoded("eyJhIjoiw6QifQ=="), "{\"a\":\"ä\"}".as_bytes());
    }
}
