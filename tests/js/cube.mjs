import kerf from "kerf";
const k = await kerf();
const pieces = k.shapes.block([1, 1, 1]).fracture(30, { seed: 7 });
console.log(pieces.length, pieces.reduce((sum, piece) => sum + piece.volume, 0).toFixed(9));
for (const piece of pieces) piece.delete();
