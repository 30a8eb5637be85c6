// `<soc-run src="/run/shop.reference-1">` shows a run inside another page, in a frame of its own.

class SocRun extends HTMLElement {
  static get observedAttributes() { return ["src"]; }

  connectedCallback() {
    if (!this.frame) {
      this.frame = document.createElement("iframe");
      this.frame.title = this.getAttribute("title") || "run";
      this.frame.allow = "fullscreen";
      Object.assign(this.frame.style, { border: "0", width: "100%", height: "100%", display: "block" });
      if (getComputedStyle(this).display === "inline") this.style.display = "block";
      if (this.clientHeight < 100) this.style.height = "480px";
      this.appendChild(this.frame);
    }
    this.show();
  }

  attributeChangedCallback() { if (this.frame) this.show(); }

  show() {
    const src = this.getAttribute("src");
    if (!src) { this.frame.removeAttribute("src"); return; }
    // Without a host of its own the address belongs to the gateway that served this module, not to the page around it.
    const target = new URL(src, new URL("..", import.meta.url));
    if (target.protocol !== "http:" && target.protocol !== "https:") return;
    target.searchParams.set("embed", "1");
    if (this.frame.src !== target.href) this.frame.src = target.href;
  }
}

customElements.define("soc-run", SocRun);
