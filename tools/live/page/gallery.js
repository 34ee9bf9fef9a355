// Bodies to begin with: the program makes them, and the page gives each its look, and a tool to begin with.
const gallery = [
  ["apple", "apple", "knife"], ["pumpkin", "pumpkin", "knife"], ["cake", "cake", "knife"], ["jelly", "gelatine", "grab"], ["polyp", "tissue", "lasso"],
  ["tissue", "tissue", "scalpel"], ["board", "wood", "break"], ["log", "log", "break"], ["stone", "stone", "break"], ["letter", "clay", "knife"],
].map(([name, look, tool]) => ({ name, look, tool }));

// The look that a body begins with. The one that the address asks for is of the body that it shows.
let lookAsked = null;
function beginWithLook() {
  const own = live.told.gallery ? gallery.find(({ name }) => name === live.told.name)?.look : undefined;
  set("look", lookAsked ?? own ?? "clay");
  lookAsked = null;
}

// An address with #bodies=true begins with the choice of bodies, once: a page that is loaded again shows the body.
let galleryAsked = false;
function beginWithGallery() {
  if (!galleryAsked) return;
  galleryAsked = false;
  history.replaceState(null, "", location.pathname + location.search);
  orders.gallery();
}

function listenToGallery() {
  $("open").addEventListener("click", () => $("file").click());
  $("file").addEventListener("change", () => {
    const files = [...$("file").files];
    $("file").value = "";  // the same file may be chosen again
    $("bodies").close();
    if (files.length > 0) openFiles(files);
  });
  for (const { name, look, tool } of gallery) {
    const button = document.createElement("button"), spot = document.createElement("i"), colors = looks[look];
    const css = (color) => "#" + color.toString(16).padStart(6, "0");
    spot.style.background = `linear-gradient(115deg, ${css(colors.skin)} 52%, ${css(colors.lip)} 52% 55%, ${css(colors.wall)} 55%)`;
    button.type = "button", button.dataset.body = name;
    button.append(spot, name[0].toUpperCase() + name.slice(1));
    button.addEventListener("click", () => {
      $("bodies").close();
      endStroke();
      set("tool", tool);
      opening(button.textContent);
      send({ show: name });
    });
    $("body-list").append(button);
  }
}
