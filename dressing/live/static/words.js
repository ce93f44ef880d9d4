"use strict";
// The words of the page, in English and Spanish.
const WORDS = {
  en: {
    pause: "Pause", step: "Step", restart: "Restart", picture: "Picture", pull: "Pull", pin: "Pin", move: "Move object",
    turn: "Turn view", fabric: "Fabric", wind: "Wind", gusts: "Gusts", gravity: "Gravity", ball_moves: "ball moves by itself",
    floor: "floor", self_contact: "cloth touches itself", wires: "triangles", rotate: "turn by itself", colour: "Colour",
    plain: "its own", stretch: "stretch", speed: "speed", cells: "Cells", grain: "Warp", pins: "Pins", object: "Object",
    unpin: "Unpin all", cut: "Cut one by one", record: "Record", friction: "Friction", texture: "stripes along warp and weft", along_warp: "strain along warp",
    along_weft: "strain along weft", pressure: "pressure", cloth: "cloth", back: "background", side: "Side", save: "Save", stop: "End",
    hints: { pull: "Drag the cloth. It is never torn and never passes through anything.", pin: "Click the cloth to pin it, a pin to let go.",
      move: "Drag the ball, the table or a pin.", turn: "Drag to turn, wheel to come nearer." },
    help: "Right drag moves the view, wheel or pinch comes nearer, shift or an empty place turns. Keys on the view: arrows, + -, space, s, r, w; p pins the middle.",
    numbers: (s) => `${s.rate} steps/s${s.rate < 57 && s.running ? ` (x ${(s.rate / 60).toFixed(2)})` : ""} · stretch ${s.stretch} % · ${s.contacts} contacts`
      + ` · ${s.crossings === null ? "no audit yet" : `<${s.crossings ? "b" : "span"}>${s.crossings} crossings</${s.crossings ? "b" : "span"}>`}`,
    lost: "The connection is gone. The cloth waits where it is; this page tries again. If toile live has ended, start it anew.", ended: "It has ended. Start toile live again.",
    fabric_numbers: (f) => `${f.density} g/m² · ${f.thickness} mm · bending ${f.bending} µN m · stretch ${f.stretch} N/m · shear ${f.shear} N/m`,
    saved: "Saved.", busy: (n) => `${n} pages show this cloth.`,
  },
  es: {
    pause: "Pausa", step: "Paso", restart: "Reiniciar", picture: "Imagen", pull: "Tirar", pin: "Fijar", move: "Mover objeto",
    turn: "Girar vista", fabric: "Tela", wind: "Viento", gusts: "Ráfagas", gravity: "Gravedad", ball_moves: "la bola se mueve sola",
    floor: "suelo", self_contact: "la tela se toca a sí misma", wires: "triángulos", rotate: "girar sola", colour: "Color",
    plain: "el suyo", stretch: "estiramiento", speed: "velocidad", cells: "Celdas", grain: "Urdimbre", pins: "Alfileres", object: "Objeto",
    unpin: "Soltar todo", cut: "Cortar uno a uno", record: "Grabar", friction: "Fricción", texture: "rayas de urdimbre y trama", along_warp: "deformación de urdimbre",
    along_weft: "deformación de trama", pressure: "presión", cloth: "tela", back: "fondo", side: "Lado", save: "Guardar", stop: "Terminar",
    hints: { pull: "Arrastra la tela. Nunca se rompe ni atraviesa nada.", pin: "Pulsa la tela para fijarla, un alfiler para soltarlo.",
      move: "Arrastra la bola, la mesa o un alfiler.", turn: "Arrastra para girar, rueda para acercar." },
    help: "Botón derecho mueve la vista, rueda o pellizco acerca, mayúsculas o un lugar vacío gira. Teclas sobre la vista: flechas, + -, espacio, s, r, w; p fija el centro.",
    numbers: (s) => `${s.rate} pasos/s${s.rate < 57 && s.running ? ` (x ${(s.rate / 60).toFixed(2)})` : ""} · estiramiento ${s.stretch} % · ${s.contacts} contactos`
      + ` · ${s.crossings === null ? "aún sin auditoría" : `<${s.crossings ? "b" : "span"}>${s.crossings} cruces</${s.crossings ? "b" : "span"}>`}`,
    lost: "Se perdió la conexión. La tela espera donde está; esta página lo intenta otra vez. Si toile live terminó, inícialo de nuevo.", ended: "Ha terminado. Inicia toile live de nuevo.",
    fabric_numbers: (f) => `${f.density} g/m² · ${f.thickness} mm · flexión ${f.bending} µN m · tracción ${f.stretch} N/m · cizalla ${f.shear} N/m`,
    saved: "Guardado.", busy: (n) => `${n} páginas muestran esta tela.`,
  },
};
