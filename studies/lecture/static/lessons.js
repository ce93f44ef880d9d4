"use strict";
// The words of the lecture, in English and Spanish.
const LESSONS = {
  en: {
    pause: "Pause", step: "Step", restart: "Again", stop: "End", back: "Back", on: "Next",
    stiffness: "Stiffness", damping: "Damping", cells: "Cells", wind: "Wind", gusts: "Gusts", gravity: "Gravity", pins: "Pins",
    method: "Integrator", model: "Model", springs: "Springs", weave: "Weave", ends: "Warp yarns", picks: "Weft yarns", yarn: "Yarn",
    energy: "total energy", error: "distance to fine steps",
    help: "Drag the cloth to pull it, an empty place to turn it. Keys: space, s one step, r again, page up and down; on a view arrows, + and -.",
    lost: "The connection is gone. The page tries again. If toile live has ended, start it anew.", ended: "It has ended. Start toile live again.",
    choices: { explicit: "explicit Euler", symplectic: "symplectic Euler", implicit: "implicit Euler", bdf2: "BDF2", springs: "mass–spring", triangles: "triangles",
      structural: "structural", shear: "and shear", all: "and bending", "one edge": "one edge", corners: "corners" },
    picture: [],
    caption(setup, lesson, k) {
      if (lesson === "remeshing") return k ? "Adaptive mesh" : "Uniform mesh";
      if (lesson === "yarns") return k ? "Woven from your yarns" : "Cotton poplin";
      return `${this.choices[setup.model]}, ${this.choices[setup.method]}`;
    },
    numbers: (one, state) => (one.exploded === null ? `${one.nodes} nodes · ${state.seconds.toFixed(1)} s${one.limit === null ? "" : ` · stable below ${(1000 * one.limit).toPrecision(2)} ms`}` : `Exploded after ${one.exploded.toFixed(2)} s. Shorten the step.`),
    lessons: {
      springs: { title: "Springs", text: `<p>Cut cloth into a grid of point masses. Springs hold neighbours at their distance (Provot 1995).</p>
        <p class="formula">E = ½ k<sub>s</sub> (|x<sub>i</sub> − x<sub>j</sub>| − L)²</p>
        <p><b>Structural</b> springs (black) run along the threads, <b>shear</b> springs (blue) along the diagonals, <b>bending</b> springs (orange) join every second mass.</p>
        <p>On the left there are structural springs only: pull a free corner, and squares fold into diamonds without any resistance. The right one has all three. Add them on the left.</p>` },
      forces: { title: "Forces", text: `<p>Every mass obeys Newton. Gravity pulls, springs pull back, and damping takes energy out.</p>
        <p class="formula">m a = m g + Σ f<sub>ij</sub></p><p class="formula">f<sub>ij</sub> = −[k<sub>s</sub> (|d| − L) + k<sub>d</sub> (ḋ · n)] n</p>
        <p>d leads from one mass to the other, n is its direction. The damping acts along the spring only: it resists lengthening, not turning, so a cloth that swings as a whole is not slowed.</p>
        <p>Left k<sub>d</sub> = 0, right 0.3 N s/m. Watch the ripples, then the total energy.</p>` },
      wind: { title: "Wind", text: `<p>Air that meets a triangle pushes it along its normal.</p>
        <p class="formula">f = ½ ρ C A |u| (u · n) n,   u = w − v</p>
        <p>ρ is the density of air, A the area, w the wind and v the velocity of the cloth. Because the <b>relative</b> velocity counts, the same force brakes cloth in still air. It grows with the square of the wind: from 4 to 8 m/s it is four times as strong.</p>
        <p>Left a steady wind. Right it has gusts: eddies that drift past.</p>` },
      explicit: { title: "Explicit Euler", text: `<p>The simplest way forward: where you are says where you go.</p>
        <p class="formula">x₁ = x₀ + h v₀</p><p class="formula">v₁ = v₀ + h M⁻¹ f(x₀, v₀)</p>
        <p>A step costs one evaluation of the forces. But a stiff spring that is a little too long is pulled back too far, more each time. For a mode of angular frequency ω, with τ = k<sub>d</sub>/k<sub>s</sub>, it is stable for</p>
        <p class="formula">h &lt; τ  while τ ω &lt; 2</p><p>and never without damping. With k<sub>s</sub> four times as large ω doubles. Raise the time step on the left until it explodes; then k<sub>s</sub>.</p>
        <p>Slow swinging is hardly damped by springs, so its energy still grows, slowly: look at the curve.</p>` },
      implicit: { title: "Implicit Euler", text: `<p>Ask instead for the step whose <b>end</b> obeys the forces there (Baraff and Witkin 1998).</p>
        <p class="formula">v₁ = v₀ + h M⁻¹ f(x₁, v₁),   x₁ = x₀ + h v₁</p><p>Linearised, it is one large sparse system, solved by conjugate gradients:</p>
        <p class="formula">(M + h D + h² K) Δv = h (f₀ − h K v₀)</p>
        <p>It stays calm at any step, and pays with energy: a swing of 1 Hz loses half of it in a second at h = 1/60 s. Left symplectic Euler, which takes v₁ instead of v₀ in x₁ and is stable for h &lt; 2/ω. BDF2 looks back two steps and loses far less.</p>
        <p>The error curves show the distance to the same model in fine steps (BDF2, 1/240 s).</p>` },
      triangles: { title: "Triangles", text: `<p>Springs know lengths, cloth knows areas. Take each triangle's map from the pattern to space instead, and its derivatives along warp and weft (Baraff and Witkin 1998).</p>
        <p class="formula">F = [w<sub>u</sub>  w<sub>v</sub>]</p><p class="formula">E = A [½ k<sub>u</sub>(|w<sub>u</sub>| − 1)² + ½ k<sub>v</sub>(|w<sub>v</sub>| − 1)² + ½ G (w<sub>u</sub>·w<sub>v</sub>)²]</p>
        <p>The numbers k<sub>u</sub>, k<sub>v</sub>, G [N/m] can be measured on a fabric and do not depend on the mesh; bending is the curvature times a rigidity.</p>
        <p>Both have the same fabric. Change the cells of each: triangles of any size are the same cloth, springs have to be tuned again.</p>` },
      remeshing: { title: "Adaptive remeshing", text: `<p>Folds need small triangles, the flat rest does not. A sizing tensor says how long edges may be (Narain, Samii and O'Brien 2012):</p>
        <p class="formula">M = curvature² / turn² + …,   e · M e ≤ 1</p>
        <p>An edge that is too long is <b>split</b>, one that may go is <b>collapsed</b>, one that lies badly is <b>flipped</b>. Momentum is kept, and no triangle may cross another.</p>
        <p>Both fall on a ball. The left one keeps its mesh. The right one is remeshed ten times a second: see where the small triangles gather.</p>` },
      yarns: { title: "Yarns", text: `<p>Where do k<sub>u</sub>, k<sub>v</sub> and G come from? From yarns. Each waves over and under the others; a pull first straightens it, against its bending, then stretches it (Peirce 1937).</p>
        <p class="formula">E = ½ k L (l/L − 1)² + ½ (B q/L)(α − α₀)²</p><p class="formula">h<sub>warp</sub> + h<sub>weft</sub> = d<sub>warp</sub> + d<sub>weft</sub></p>
        <p>What the warp gains in wave height the weft loses: that is why pulling one way shortens the other. This is what <code>toile fabric weave</code> computes. Change the weave and see its curve and its drape, on the right.</p>` },
      compare: { title: "Side by side", text: `<p>Two cloths of the same fabric. Choose the model and the integrator of each, k<sub>s</sub>, k<sub>d</sub>, and the time step until the explicit one explodes.</p>
        <p class="formula">mass–spring: E = ½ k<sub>s</sub>(|d| − L)²</p><p class="formula">stable: explicit h &lt; k<sub>d</sub>/k<sub>s</sub>, symplectic h &lt; 2/ω</p>
        <p>The curves show the total energy and the distance to the same model in fine steps: blue left, orange right.</p>` },
    },
  },
  es: {
    pause: "Pausa", step: "Paso", restart: "Otra vez", stop: "Terminar", back: "Atrás", on: "Siguiente",
    stiffness: "Rigidez", damping: "Amortiguación", cells: "Celdas", wind: "Viento", gusts: "Ráfagas", gravity: "Gravedad", pins: "Alfileres",
    method: "Integrador", model: "Modelo", springs: "Resortes", weave: "Ligamento", ends: "Hilos de urdimbre", picks: "Hilos de trama", yarn: "Hilo",
    energy: "energía total", error: "distancia a pasos finos",
    help: "Arrastra la tela para tirar de ella, un lugar vacío para girarla. Teclas: espacio, s un paso, r otra vez, re pág y av pág; sobre una vista flechas, + y -.",
    lost: "Se perdió la conexión. La página lo intenta otra vez. Si toile live terminó, inícialo de nuevo.", ended: "Ha terminado. Inicia toile live de nuevo.",
    choices: { explicit: "Euler explícito", symplectic: "Euler simpléctico", implicit: "Euler implícito", bdf2: "BDF2", springs: "masa–resorte", triangles: "triángulos",
      structural: "estructurales", shear: "y de cizalla", all: "y de flexión", "one edge": "un borde", corners: "esquinas", plain: "tafetán", twill: "sarga 2/2", satin: "raso" },
    picture: [["from above, warp upright", "desde arriba, urdimbre vertical"], ["a warp yarn from the side, crimp", "un hilo de urdimbre de lado, rizado"],
      ["a weft yarn from the side, crimp", "un hilo de trama de lado, rizado"], ["tension [N/m] over strain [%], pulled alone", "tensión [N/m] por deformación [%], en un sentido"],
      [">warp<", ">urdimbre<"], [">weft<", ">trama<"]],
    caption(setup, lesson, k) {
      if (lesson === "remeshing") return k ? "Malla adaptativa" : "Malla uniforme";
      if (lesson === "yarns") return k ? "Tejida con tus hilos" : "Popelina de algodón";
      return `${this.choices[setup.model]}, ${this.choices[setup.method]}`;
    },
    numbers: (one, state) => (one.exploded === null ? `${one.nodes} nodos · ${state.seconds.toFixed(1)} s${one.limit === null ? "" : ` · estable bajo ${(1000 * one.limit).toPrecision(2)} ms`}` : `Explotó a los ${one.exploded.toFixed(2)} s. Acorta el paso.`),
    lessons: {
      springs: { title: "Resortes", text: `<p>Corta la tela en una cuadrícula de masas puntuales. Los resortes mantienen a las vecinas a su distancia (Provot 1995).</p>
        <p class="formula">E = ½ k<sub>s</sub> (|x<sub>i</sub> − x<sub>j</sub>| − L)²</p>
        <p>Los <b>estructurales</b> (negro) siguen los hilos, los de <b>cizalla</b> (azul) las diagonales, los de <b>flexión</b> (naranja) unen cada segunda masa.</p>
        <p>A la izquierda solo hay estructurales: tira de una esquina libre y los cuadrados se vuelven rombos sin resistencia. La derecha tiene los tres. Añádelos a la izquierda.</p>` },
      forces: { title: "Fuerzas", text: `<p>Cada masa obedece a Newton. La gravedad tira, los resortes devuelven y la amortiguación quita energía.</p>
        <p class="formula">m a = m g + Σ f<sub>ij</sub></p><p class="formula">f<sub>ij</sub> = −[k<sub>s</sub> (|d| − L) + k<sub>d</sub> (ḋ · n)] n</p>
        <p>d va de una masa a la otra, n es su dirección. La amortiguación actúa solo a lo largo del resorte: resiste que se alargue, no que gire; no frena una tela que oscila entera.</p>
        <p>Izquierda k<sub>d</sub> = 0, derecha 0,3 N s/m. Mira las ondas y después la energía total.</p>` },
      wind: { title: "Viento", text: `<p>El aire que llega a un triángulo lo empuja según su normal.</p>
        <p class="formula">f = ½ ρ C A |u| (u · n) n,   u = w − v</p>
        <p>ρ es la densidad del aire, A el área, w el viento y v la velocidad de la tela. Como cuenta la velocidad <b>relativa</b>, la misma fuerza frena la tela en aire quieto. Crece con el cuadrado del viento: de 4 a 8 m/s es cuatro veces mayor.</p>
        <p>Izquierda, viento constante. Derecha, ráfagas: remolinos que pasan.</p>` },
      explicit: { title: "Euler explícito", text: `<p>El camino más simple: donde estás dice adónde vas.</p>
        <p class="formula">x₁ = x₀ + h v₀</p><p class="formula">v₁ = v₀ + h M⁻¹ f(x₀, v₀)</p>
        <p>Un paso cuesta una evaluación de las fuerzas. Pero un resorte rígido algo largo vuelve demasiado, y cada vez más. Para un modo de frecuencia angular ω, con τ = k<sub>d</sub>/k<sub>s</sub>, es estable si</p>
        <p class="formula">h &lt; τ  mientras τ ω &lt; 2</p><p>y nunca sin amortiguación. Con k<sub>s</sub> cuatro veces mayor, ω se duplica. Sube el paso de la izquierda hasta que explote; después k<sub>s</sub>.</p>
        <p>Los resortes casi no amortiguan la oscilación lenta: su energía aún crece, despacio. Mira la curva.</p>` },
      implicit: { title: "Euler implícito", text: `<p>Pide en cambio el paso cuyo <b>final</b> obedece a las fuerzas de allí (Baraff y Witkin 1998).</p>
        <p class="formula">v₁ = v₀ + h M⁻¹ f(x₁, v₁),   x₁ = x₀ + h v₁</p><p>Linealizado es un gran sistema disperso, resuelto por gradientes conjugados:</p>
        <p class="formula">(M + h D + h² K) Δv = h (f₀ − h K v₀)</p>
        <p>Queda en calma con cualquier paso y paga con energía: una oscilación de 1 Hz pierde la mitad en un segundo con h = 1/60 s. A la izquierda Euler simpléctico, que toma v₁ en vez de v₀ en x₁ y es estable si h &lt; 2/ω. BDF2 mira dos pasos atrás y pierde mucho menos.</p>
        <p>Las curvas de error muestran la distancia al mismo modelo en pasos finos (BDF2, 1/240 s).</p>` },
      triangles: { title: "Triángulos", text: `<p>Los resortes saben de longitudes, la tela de áreas. Toma la aplicación de cada triángulo del patrón al espacio y sus derivadas según urdimbre y trama (Baraff y Witkin 1998).</p>
        <p class="formula">F = [w<sub>u</sub>  w<sub>v</sub>]</p><p class="formula">E = A [½ k<sub>u</sub>(|w<sub>u</sub>| − 1)² + ½ k<sub>v</sub>(|w<sub>v</sub>| − 1)² + ½ G (w<sub>u</sub>·w<sub>v</sub>)²]</p>
        <p>Los números k<sub>u</sub>, k<sub>v</sub>, G [N/m] se miden en una tela y no dependen de la malla; la flexión es la curvatura por una rigidez.</p>
        <p>Ambas tienen la misma tela. Cambia las celdas de cada una: triángulos de cualquier tamaño son la misma tela, los resortes hay que ajustarlos de nuevo.</p>` },
      remeshing: { title: "Remallado adaptativo", text: `<p>Los pliegues piden triángulos pequeños, lo plano no. Un tensor dice cuánto pueden medir las aristas (Narain, Samii y O'Brien 2012):</p>
        <p class="formula">M = curvatura² / giro² + …,   e · M e ≤ 1</p>
        <p>Una arista demasiado larga se <b>divide</b>, una que sobra se <b>contrae</b>, una mal puesta se <b>voltea</b>. Se conserva la cantidad de movimiento y ningún triángulo cruza a otro.</p>
        <p>Ambas caen sobre una bola. La izquierda conserva su malla. La derecha se remalla diez veces por segundo: mira dónde se juntan los triángulos pequeños.</p>` },
      yarns: { title: "Hilos", text: `<p>¿De dónde salen k<sub>u</sub>, k<sub>v</sub> y G? De los hilos. Cada uno ondula sobre y bajo los otros; un tirón primero lo endereza, contra su flexión, y después lo estira (Peirce 1937).</p>
        <p class="formula">E = ½ k L (l/L − 1)² + ½ (B q/L)(α − α₀)²</p><p class="formula">h<sub>urdimbre</sub> + h<sub>trama</sub> = d<sub>urdimbre</sub> + d<sub>trama</sub></p>
        <p>Lo que gana la onda de la urdimbre lo pierde la de la trama: por eso tirar en un sentido acorta el otro. Es lo que calcula <code>toile fabric weave</code>. Cambia el ligamento y mira su curva y su caída, a la derecha.</p>` },
      compare: { title: "Lado a lado", text: `<p>Dos telas iguales. Elige el modelo y el integrador de cada una, k<sub>s</sub>, k<sub>d</sub> y el paso hasta que el explícito explote.</p>
        <p class="formula">masa–resorte: E = ½ k<sub>s</sub>(|d| − L)²</p><p class="formula">estable: explícito h &lt; k<sub>d</sub>/k<sub>s</sub>, simpléctico h &lt; 2/ω</p>
        <p>Las curvas muestran la energía total y la distancia al mismo modelo en pasos finos: azul izquierda, naranja derecha.</p>` },
    },
  },
};
