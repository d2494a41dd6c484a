// Draws each webgui scene when its box comes into view.
(() => {
  const folder = document.currentScript.src.replace(/[^/]*$/, "scenes/");
  window.webguiScenes = {};

  function draw(box) {
    const script = document.createElement("script");
    script.src = `${folder}${box.dataset.scene}.js`;
    script.onload = () => {
      const scene = new webgui.Scene();
      scene.init(box, window.webguiScenes[box.dataset.scene]);
      scene.container.style.position = "relative";
      scene.render();
      box.dataset.drawn = "yes";
    };
    document.head.appendChild(script);
  }

  document.addEventListener("DOMContentLoaded", () => {
    const observer = new IntersectionObserver((entries) => {
      for (const entry of entries.filter((entry) => entry.isIntersecting)) {
        observer.unobserve(entry.target);
        draw(entry.target);
      }
    }, { rootMargin: "300px" });
    document.querySelectorAll(".webgui").forEach((box) => observer.observe(box));
  });
})();
