//! Pages in a headless Chromium, where one is installed.

use std::path::{Path, PathBuf};

use base64::prelude::{BASE64_STANDARD, Engine as _};

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
    let bytes =
        BASE64_STANDARD.decode(coded.trim()).map_err(|why| wrong(&format!("the answer is no base 64: {why}")))?;
    let found: serde_json::Value = serde_json::from_slice(&bytes)?;
    match found.get("failed") {
        Some(why) => Err(wrong(&format!("the script failed: {why}"))),
        None => Ok(found),
    }
}
