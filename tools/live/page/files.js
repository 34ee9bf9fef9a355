// A model that is dropped on the page is opened in place of the one that is shown.
const openable = /\.(obj|ply|stl|off|glb)$/i, largestModel = 256;  // MB, as the program takes them

function listenToFiles() {
  const drops = (e) => e.dataTransfer?.types.includes("Files");
  document.addEventListener("dragover", (e) => {
    if (!drops(e)) return;
    e.preventDefault();
    document.body.classList.add("dropping");
  });
  document.addEventListener("dragleave", (e) => e.relatedTarget === null && document.body.classList.remove("dropping"));
  document.addEventListener("drop", (e) => {
    if (!drops(e)) return;
    e.preventDefault();
    document.body.classList.remove("dropping");
    openFiles([...e.dataTransfer.files]);
  });
}
// Shown until the first state of the new run, or the reason why there is none.
function opening(name) { $("wait").textContent = `Opening ${name} …`, $("wait").hidden = false; }
async function openFiles(files) {
  const models = files.filter((file) => openable.test(file.name));
  if (models.length !== 1) return notice({ error: models.length === 0 ? `${files[0]?.name ?? "This"} cannot be opened here: give a model (OBJ, PLY, STL, OFF or GLB)` : "Open one model at a time" });
  const [file] = models;
  if (files.reduce((sum, { size }) => sum + size, 0) > largestModel * 2 ** 20) return notice({ error: `${file.name} has more than ${largestModel} MB` });
  endStroke();
  opening(file.name);
  try {
    const reason = await openModel(file, files.filter((other) => other !== file));
    if (reason !== "") notice({ error: reason });
  } catch (problem) {
    notice({ error: `${file.name} could not be sent: ${problem.message}` });
  }
  $("wait").hidden = wire.open;
}
