// Looks: colours of skin, walls and lips, and solid textures, which are functions of the place in the material and of the
// depth below the skin. Lengths are those of shown coordinates, in which the body at rest is in the unit sphere.
// `wet`: the strength of the clear coat on skin and walls. `soft`: how far light is scattered round an edge, per colour.
const looks = {
  clay: { skin: 0xe0803a, wall: 0xf6d8a8, lip: 0x7a3212, glow: 0xff9a58, inner: 0xffe9c8, wet: [0.12, 0.06], soft: [0.1, 0.08, 0.06], solid: 0 },
  tissue: { skin: 0xd99a88, wall: 0xb23a3f, lip: 0x6e1420, glow: 0xff8f80, inner: 0xff6a60, wet: [0.25, 0.9], soft: [0.45, 0.16, 0.1], solid: 1 },
  apple: { skin: 0xb8342c, wall: 0xf6efd2, lip: 0x5e120e, glow: 0xff7a50, inner: 0xfff6d8, wet: [0.6, 0.3], soft: [0.22, 0.2, 0.12], solid: 2 },
  pumpkin: { skin: 0xdd7a1c, wall: 0xf2b04a, lip: 0x7a3a08, glow: 0xffa040, inner: 0xffd080, wet: [0.35, 0.3], soft: [0.25, 0.16, 0.06], solid: 3 },
  wood: { skin: 0xc89058, wall: 0xd8a468, lip: 0x6a4020, glow: 0xd89858, inner: 0xe0b078, wet: [0.08, 0.03], soft: [0, 0, 0], solid: 4 },
  log: { skin: 0x6a4c34, wall: 0xd8a468, lip: 0x3a2412, glow: 0x8a6a48, inner: 0xe0b078, wet: [0.02, 0.03], soft: [0, 0, 0], solid: 5 },
  cake: { skin: 0x55301f, wall: 0xf2cf86, lip: 0x2f180e, glow: 0x8a5236, inner: 0xffe8b8, wet: [0.5, 0], soft: [0.12, 0.1, 0.06], solid: 6 },
  gelatine: { skin: 0x4fae5c, wall: 0xa5e08a, lip: 0x1d5a2c, glow: 0x9cff9a, inner: 0xd8ffc0, wet: [1, 1], soft: [0.3, 0.5, 0.3], solid: 0 },
  stone: { skin: 0x9a948c, wall: 0xb4aea4, lip: 0x4c4842, glow: 0x908a80, inner: 0xa8a298, wet: [0.03, 0], soft: [0, 0, 0], solid: 7 },
};

// GLSL. `solidColor(p, d, plain)`: p relative to the middle of the body, d below the skin (0 on it), plain: the look's one
// colour. axis: the longest direction of the body at rest; up: against gravity.
const solidTextures = `
  uniform vec3 solidAxis, solidUp;
  float hashed(vec3 p) {
    p = fract(p * vec3(0.1031, 0.1030, 0.0973));
    p += dot(p, p.yxz + 33.33);
    return fract((p.x + p.y) * p.z);
  }
  float noise(vec3 p) {
    vec3 i = floor(p), f = fract(p);
    i += 57.0;
    f = f * f * (3.0 - 2.0 * f);
    return mix(mix(mix(hashed(i), hashed(i + vec3(1, 0, 0)), f.x), mix(hashed(i + vec3(0, 1, 0)), hashed(i + vec3(1, 1, 0)), f.x), f.y),
      mix(mix(hashed(i + vec3(0, 0, 1)), hashed(i + vec3(1, 0, 1)), f.x), mix(hashed(i + vec3(0, 1, 1)), hashed(i + vec3(1, 1, 1)), f.x), f.y), f.z);
  }
  // Distance from the middle of the nearest cell of a jittered grid of the eight around a point.
  float cells(vec3 p) {
    vec3 i = floor(p - 0.5);
    float least = 9.0;
    for (int k = 0; k < 8; k++) {
      float fk = float(k);
      vec3 at = i + vec3(mod(fk, 2.0), mod(floor(fk / 2.0), 2.0), floor(fk / 4.0)), away = at + 0.25 + 0.5 * vec3(hashed(at), hashed(at + 17.0), hashed(at + 41.0)) - p;
      least = min(least, dot(away, away));
    }
    return sqrt(least);
  }
  vec3 tissue(vec3 p, float d) {
    float wave = 0.5 * noise(5.0 * p) + 0.5 * noise(11.0 * p);
    if (d <= 0.0) return mix(vec3(0.86, 0.62, 0.53), vec3(0.80, 0.50, 0.44), wave) * (0.94 + 0.06 * noise(60.0 * p));
    float dermis = 0.022, fat = 0.085 + 0.05 * (wave - 0.5), lobule = cells(34.0 * p);
    vec3 yellow = mix(vec3(0.98, 0.83, 0.47), vec3(0.80, 0.52, 0.24), smoothstep(0.42, 0.72, lobule));
    vec3 along = p - 0.9 * solidAxis * dot(p, solidAxis);  // stretched along the axis: fibres
    float fibre = noise(46.0 * along + 2.0 * noise(6.0 * p)), marbling = smoothstep(0.70, 0.80, noise(7.0 * along + 3.0));
    vec3 red = mix(vec3(0.50, 0.07, 0.08), vec3(0.74, 0.20, 0.18), fibre);
    red = mix(red, vec3(0.93, 0.74, 0.62), 0.7 * marbling);
    vec3 c = mix(yellow, red, smoothstep(fat - 0.006, fat + 0.006, d));
    c = mix(c, vec3(0.95, 0.90, 0.85), 0.8 * (1.0 - smoothstep(0.0, 0.008, abs(d - fat))));  // the fascia between both
    return mix(vec3(0.93, 0.66, 0.60), c, smoothstep(dermis - 0.006, dermis + 0.004, d));
  }
  vec3 apple(vec3 p, float d) {
    float h = dot(p, solidUp);
    vec3 side = normalize(cross(solidUp, abs(solidUp.z) < 0.5 ? vec3(0, 0, 1) : vec3(1, 0, 0))), front = cross(solidUp, side);
    vec2 q = vec2(dot(p, side), dot(p, front));
    float r = length(q), a = atan(q.y, q.x);
    if (d <= 0.0) {
      float streak = noise(vec3(9.0 * q / max(r, 0.05), 1.2 * h)) * 0.6 + 0.4 * noise(vec3(30.0 * q / max(r, 0.05), 2.0 * h));
      vec3 c = mix(vec3(0.62, 0.07, 0.09), vec3(0.90, 0.56, 0.22), smoothstep(0.42, 0.85, streak + 0.35 * smoothstep(0.25, 0.0, r)));
      return mix(c, vec3(0.95, 0.80, 0.55), 0.7 * smoothstep(0.20, 0.10, cells(26.0 * p)));
    }
    vec3 flesh = mix(vec3(0.98, 0.95, 0.80), vec3(0.94, 0.88, 0.66), noise(18.0 * p)) * (0.97 + 0.03 * noise(90.0 * p));
    vec3 c = mix(vec3(0.80, 0.84, 0.45), flesh, smoothstep(0.010, 0.045, d));
    c = mix(vec3(0.70, 0.12, 0.12), c, smoothstep(0.004, 0.012, d));
    float core = 0.27 * sqrt(max(0.0, 1.0 - h * h / 0.09));
    c = mix(c, vec3(0.76, 0.80, 0.48), 0.8 * (1.0 - smoothstep(0.0, 0.014, abs(r - core))));
    // Five seeds, each in its chamber.
    float fifth = 6.2831853 / 5.0, b = mod(a + 0.5 * fifth, fifth) - 0.5 * fifth;
    vec2 at = r * vec2(cos(b), sin(b));
    float chamber = length(vec3((at.x - 0.115) / 0.085, at.y / 0.040, h / 0.13)), seed = length(vec3((at.x - 0.10) / 0.042, at.y / 0.026, h / 0.085));
    c = mix(c, vec3(0.84, 0.78, 0.52), 1.0 - smoothstep(0.9, 1.05, chamber));
    return mix(c, vec3(0.27, 0.13, 0.06), 1.0 - smoothstep(0.9, 1.05, seed));
  }
  vec3 pumpkin(vec3 p, float d) {
    float n = noise(8.0 * p);
    if (d <= 0.0) return mix(vec3(0.90, 0.47, 0.09), vec3(0.78, 0.36, 0.05), n) + 0.05 * (noise(50.0 * p) - 0.5);
    vec3 flesh = mix(vec3(0.97, 0.68, 0.22), vec3(0.93, 0.58, 0.14), noise(14.0 * p));
    vec3 c = mix(vec3(0.62, 0.62, 0.18), flesh, smoothstep(0.010, 0.035, d));
    float pulp = 0.24 + 0.04 * n, strings = noise(vec3(16.0, 16.0, 16.0) * p + 5.0 * noise(5.0 * p));
    vec3 wet = mix(vec3(0.95, 0.62, 0.16), vec3(0.78, 0.38, 0.07), smoothstep(0.3, 0.7, strings));
    float seed = cells(9.0 * p);
    wet = mix(wet, vec3(0.97, 0.92, 0.76), 1.0 - smoothstep(0.20, 0.24, seed));
    return mix(c, wet, smoothstep(pulp - 0.01, pulp + 0.015, d));
  }
  vec3 wood(vec3 p) {
    vec3 across = p - solidAxis * dot(p, solidAxis);
    across += 0.035 * vec3(noise(3.0 * p), noise(3.0 * p + 9.0), noise(3.0 * p + 21.0)) + vec3(0.021, 0.013, 0.034);
    float r = length(across) * 22.0, ring = fract(r), late = smoothstep(0.45, 0.95, ring) * (1.0 - smoothstep(0.95, 1.0, ring));
    float grain = noise(vec3(70.0) * (p - 0.93 * solidAxis * dot(p, solidAxis)));
    vec3 c = mix(vec3(0.88, 0.69, 0.45), vec3(0.60, 0.37, 0.18), 0.85 * late + 0.18 * (hashed(vec3(floor(r))) - 0.5));
    return c * (0.90 + 0.16 * grain);
  }
  vec3 trunk(vec3 p, float d) {
    float rough = noise(vec3(26.0) * (p - 0.75 * solidAxis * dot(p, solidAxis)));
    vec3 bark = mix(vec3(0.24, 0.16, 0.11), vec3(0.50, 0.38, 0.28), rough);
    if (d <= 0.0) return bark;
    float edge = 0.035 + 0.015 * rough;
    vec3 c = mix(wood(p), vec3(0.93, 0.80, 0.58), 0.7 * (1.0 - smoothstep(edge, edge + 0.05, d)));
    return mix(bark, c, smoothstep(edge - 0.005, edge + 0.005, d));
  }
  vec3 cake(vec3 p, float d) {
    float h = dot(p, solidUp);
    vec3 icing = vec3(0.30, 0.15, 0.09) * (0.85 + 0.3 * noise(12.0 * p));
    if (d <= 0.0) {
      float sprinkle = cells(15.0 * p), hue = hashed(floor(15.0 * p - 0.5) + 3.0);
      vec3 sugar = 0.55 + 0.45 * cos(6.2831853 * (hue + vec3(0.0, 0.33, 0.67)));
      return mix(sugar, icing, smoothstep(0.14, 0.18, sprinkle));
    }
    float pore = cells(30.0 * p) * 0.6 + cells(62.0 * p) * 0.4;
    vec3 sponge = mix(vec3(0.72, 0.46, 0.18), vec3(0.97, 0.82, 0.50), smoothstep(0.12, 0.42, pore));
    float layer = abs(fract(3.2 * h + 0.5 + 0.05 * noise(9.0 * p)) - 0.5) / 3.2;
    sponge = mix(vec3(0.99, 0.96, 0.90), sponge, smoothstep(0.030, 0.036, layer));
    sponge = mix(vec3(0.66, 0.06, 0.13), sponge, smoothstep(0.010, 0.014, layer));
    return mix(icing, sponge, smoothstep(0.030, 0.036, d + 0.01 * noise(20.0 * p)));
  }
  vec3 stone(vec3 p, float d) {
    float grain = cells(24.0 * p), kind = hashed(floor(24.0 * p - 0.5));
    vec3 c = mix(vec3(0.70, 0.66, 0.61), vec3(0.50, 0.47, 0.45), noise(5.0 * p));
    c = mix(c, kind < 0.35 ? vec3(0.20, 0.19, 0.20) : kind < 0.6 ? vec3(0.86, 0.82, 0.78) : vec3(0.72, 0.55, 0.48), 0.8 * (1.0 - smoothstep(0.28, 0.40, grain)));
    return d <= 0.0 ? mix(c, vec3(0.45, 0.43, 0.38), 0.45) : c;
  }
  vec3 solidColor(vec3 p, float d, vec3 plain) {
    #if SOLID == 1
      return tissue(p, d);
    #elif SOLID == 2
      return apple(p, d);
    #elif SOLID == 3
      return pumpkin(p, d);
    #elif SOLID == 4
      return wood(p);
    #elif SOLID == 5
      return trunk(p, d);
    #elif SOLID == 6
      return cake(p, d);
    #elif SOLID == 7
      return stone(p, d);
    #else
      return plain;
    #endif
  }
`;
