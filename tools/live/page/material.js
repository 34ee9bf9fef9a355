// How the body is lit: light that soft material scatters, a sky that is reflected by what is wet, and the dark of wounds.
const groundPlane = { value: new THREE.Vector4(0, 0, 0, 1e3) };  // in the eye's coordinates: a point's height above the ground
const lighting = {
  up: { value: new THREE.Vector3(0, 0, 1) }, sun: { value: new THREE.Vector3(0, 0, 1) },  // directions in the eye's coordinates
  axis: { value: new THREE.Vector3(1, 0, 0) }, vertical: { value: new THREE.Vector3(0, 0, 1) },  // of the body at rest
  covered: { value: 1 },  // how opaque the skin is
  heated: { value: 0 },  // 1: the stress is painted on the surface
};
const floats = (list) => `vec3(${list.map((x) => Number(x).toFixed(4)).join(", ")})`;

const softShader = {
  vertexHead: "attribute vec3 rest; attribute float gap; attribute float heat; varying vec3 vRest; varying float vGap; varying float vHeat;\n",
  vertex: "vRest = rest; vGap = gap; vHeat = heat;\n#include <begin_vertex>",
  head: `
    varying vec3 vRest; varying float vGap; varying float vHeat;
    uniform vec3 glow, upEye, sunEye, softness; uniform vec4 groundPlane; uniform float wet, heated, covered;
    ${depthShader}
    ${solidTextures}
    vec3 heatColor(float t) {
      float s = clamp(t, 0.0, 1.0) * 4.0;
      ${stops.slice(1).map((stop, i) => `${i < 3 ? `if (s < ${i + 1}.0) ` : ""}return mix(${floats(stops[i])}, ${floats(stop)}, s - ${i}.0);`).join("\n      ")}
    }
    // The sky that wet things reflect: a ground, a horizon, a bright zenith, a window and the sun.
    vec3 skyAt(vec3 direction) {
      float h = dot(direction, upEye);
      vec3 tone = h < 0.0 ? mix(vec3(0.62, 0.64, 0.66), vec3(0.30, 0.29, 0.28), min(1.0, -2.0 * h)) : mix(vec3(0.72, 0.76, 0.80), vec3(0.86, 0.92, 1.0), h);
      float s = max(0.0, dot(direction, sunEye));
      return tone + vec3(2.2, 2.1, 1.9) * smoothstep(0.985, 0.995, s) + 0.35 * smoothstep(0.75, 0.95, s);
    }`,
  // Light that has gone into the material comes out round the edge between light and shade: red farther than blue.
  direct: `
    #include <lights_phong_pars_fragment>
    void RE_Direct_Soft(const in IncidentLight directLight, const in GeometricContext geometry, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight) {
      float facing = dot(geometry.normal, directLight.direction);
      vec3 wrapped = clamp((vec3(facing) + softness) / (1.0 + softness), 0.0, 1.0);
      reflectedLight.directDiffuse += PI * wrapped * directLight.color * BRDF_Diffuse_Lambert(material.diffuseColor);
      reflectedLight.directSpecular += PI * max(0.0, facing) * directLight.color * BRDF_Specular_BlinnPhong(directLight, geometry, material.specularColor, material.specularShininess) * material.specularStrength;
    }
    #undef RE_Direct
    #define RE_Direct RE_Direct_Soft`,
  color: `
    #include <color_fragment>
    #ifdef WALL
      float depth = max(0.0005, depthAt(vRest));
      diffuseColor.rgb = solidColor(vRest, depth, diffuseColor.rgb);
    #elif !defined(USE_MAP) && !defined(USE_COLOR)
      diffuseColor.rgb = solidColor(vRest, 0.0, diffuseColor.rgb);
    #endif
    diffuseColor.rgb = mix(diffuseColor.rgb, heatColor(vHeat), heated);`,
  end: `
    vec3 toEye = normalize(vViewPosition);
    float across = abs(dot(normal, toEye)), upward = dot(normal, upEye) * 0.5 + 0.5;
    float grazing = pow(1.0 - across, 2.5);
    outgoingLight += (1.0 - 0.7 * heated) * glow * (0.04 + 0.30 * grazing) * (0.35 + 0.65 * upward);
    float height = dot(-vViewPosition, groundPlane.xyz) + groundPlane.w;
    float open = mix(0.72, 1.0, smoothstep(0.0, 0.42, height + 0.25 * max(0.0, dot(normal, groundPlane.xyz))));
    #ifdef WALL
      // What a wound that is vGap wide leaves to see of the sky, this far below the skin, as far as that is opaque.
      open *= mix(1.0, mix(0.22, 1.0, vGap / sqrt(vGap * vGap + 0.5 * depth * depth + 1e-8)), covered);
    #endif
    outgoingLight *= open;
    #ifdef COATED
      float mirrored = wet * (0.05 + 0.7 * pow(1.0 - across, 5.0));
      outgoingLight = mix(outgoingLight, skyAt(reflect(-toEye, normal)) * open, mirrored);
    #endif
    // Above a shoulder, brightness approaches 1 and never clips: pale walls keep their shading. Hues stay.
    float shoulder = 0.75, most = max(outgoingLight.r, max(outgoingLight.g, outgoingLight.b));
    if (most > shoulder) outgoingLight *= (1.0 - (1.0 - shoulder) * exp((shoulder - most) / (1.0 - shoulder))) / most;
    #include <envmap_fragment>`,
};

function compileSoft(shader) {
  const { own } = this.userData;
  Object.assign(shader.uniforms, {
    glow: { value: own.glow }, softness: { value: own.softness }, wet: own.wet, groundPlane, heated: lighting.heated, covered: lighting.covered,
    upEye: lighting.up, sunEye: lighting.sun, solidAxis: lighting.axis, solidUp: lighting.vertical,
    depthMap: depthField.map, depthBox: depthField.box, depthRange: depthField.range,
  });
  shader.vertexShader = softShader.vertexHead + shader.vertexShader.replace("#include <begin_vertex>", softShader.vertex);
  shader.fragmentShader = shader.fragmentShader.replace("#include <common>", "#include <common>\n" + softShader.head).replace("#include <lights_phong_pars_fragment>", softShader.direct)
    .replace("#include <color_fragment>", softShader.color).replace("#include <envmap_fragment>", softShader.end);
}
// A material of the body. `values`: what several materials have in common (softValues()).
function softMaterial(values, more = {}) {
  const material = new THREE.MeshPhongMaterial({ specular: 0x1b1a19, shininess: 26, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...more });
  material.userData.own = values;
  material.defines = { SOLID: 0, ...(values.wall ? { WALL: 1 } : {}) };
  material.onBeforeCompile = compileSoft.bind(material);
  return material;
}
const softValues = (wall) => ({ wall, glow: new THREE.Color(), softness: new THREE.Vector3(), wet: { value: 0 } });

// Gives a material the colours of a look. What it computes for each pixel is compiled anew.
function dressMaterial(material, look) {
  const { own } = material.userData, coat = look.wet[own.wall ? 1 : 0], solid = quality.solids ? look.solid : 0, coated = coat > 0 && quality.coat;
  material.color.set(material.userData.painted ? 0xffffff : own.wall ? look.wall : look.skin);
  own.glow.set(own.wall ? look.inner : look.glow), own.softness.set(...look.soft), own.wet.value = coat;
  if (material.defines.SOLID === solid && !!material.defines.COATED === coated) return;
  material.defines.SOLID = solid;
  if (coated) material.defines.COATED = 1;
  else delete material.defines.COATED;
  material.needsUpdate = true;
}
