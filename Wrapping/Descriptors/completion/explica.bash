# bash completion of explica, generated from the commands' own declarations.
_explica() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  local command=${COMP_WORDS[1]} options= choices=
  if [[ $COMP_CWORD == 1 ]]; then
    COMPREPLY=($(compgen -W 'bids descriptors embed history phantom polygon replay report run segment study surface thickness unfold verify view' -- "$word"))
    return
  fi
  if [[ $COMP_CWORD == 2 ]]; then
    case $command in
    phantom) choices+=' cortex' ;;&
    phantom) choices+=' eccentric' ;;&
    phantom) choices+=' polygon19' ;;&
    phantom) choices+=' polygon34' ;;&
    phantom) choices+=' shell' ;;&
    phantom) choices+=' spheroid' ;;&
    phantom) choices+=' ventricle' ;;&
    study) choices+=' check' ;;&
    study) choices+=' group' ;;&
    study) choices+=' list' ;;&
    study) choices+=' participant' ;;&
    study) choices+=' schema' ;;&
    *) ;;
    esac
    if [[ -n $choices ]]; then
      COMPREPLY=($(compgen -W "$choices" -- "$word"))
      return
    fi
  fi
  case $command in
    phantom) command="$command ${COMP_WORDS[2]}" ;;
  esac
  case $command in
    'bids')
      options=' --participant-label --hemispheres --skip-bids-validator --unfold-surface --given-surfaces --steps --segment.mask --segment.atlas --segment.atlas-legend --segment.xform --segment.frame --segment.smooth --segment.bias-width --segment.max-iterations --segment.tolerance --segment.hemisphere --segment.core-depth --thickness.inner-level --thickness.outer-level --thickness.level --thickness.level-inside --thickness.xform --thickness.frame --thickness.inner --thickness.tissue --thickness.outer --thickness.insulated --thickness.boundary --thickness.open-ends --thickness.per-slice --thickness.sulci --thickness.facing --thickness.method --thickness.lambda --thickness.layers --thickness.layer-kind --thickness.grid --thickness.aha --thickness.rv-insertion --surface.inner-level --surface.outer-level --surface.grey-share --surface.insulated-mask --surface.level --surface.white-surface --surface.pial-surface --surface.mid-surface --surface.surface-space --surface.atlas --surface.atlas-legend --surface.parcellation --surface.xform --surface.frame --surface.preset --surface.white --surface.grey --surface.fill --surface.insulated --surface.hemisphere --surface.no-fill --surface.close-edges --surface.genus --surface.faces --surface.steps --surface.freesurfer --surface.fs-volume --unfold.surface-space --unfold.fs-volume --unfold.viewpoint --unfold.direction --unfold.distance --unfold.view-line --unfold.view-surface --unfold.center --unfold.vertex --unfold.radius --unfold.metric --unfold.cone --unfold.label --unfold.label-key --unfold.adjust-region --unfold.repair --unfold.surround --unfold.collar-rings --unfold.contact-range --unfold.largest-move --unfold.method --unfold.knot --unfold.keep-areas --unfold.time-step --unfold.area-weight --unfold.spring-weight --unfold.knot-weight --unfold.contact-weight --unfold.lift-weight --unfold.collar-weight --unfold.target-visibility --unfold.area-tolerance --unfold.max-iterations --unfold.max-time --unfold.frames --unfold.resume --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --hemispheres) COMPREPLY=($(compgen -W 'L R' -- "$word")); return ;;
        --unfold-surface) COMPREPLY=($(compgen -W 'white mid pial' -- "$word")); return ;;
        --given-surfaces) COMPREPLY=($(compgen -W 'use remake' -- "$word")); return ;;
        --steps) COMPREPLY=($(compgen -W 'segment thickness surface unfold report' -- "$word")); return ;;
        --segment.xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --segment.hemisphere) COMPREPLY=($(compgen -W 'both L R' -- "$word")); return ;;
        --thickness.level-inside) COMPREPLY=($(compgen -W 'auto above below' -- "$word")); return ;;
        --thickness.xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --thickness.boundary) COMPREPLY=($(compgen -W 'subvoxel staircase embedding' -- "$word")); return ;;
        --thickness.sulci) COMPREPLY=($(compgen -W 'recover ignore' -- "$word")); return ;;
        --thickness.method) COMPREPLY=($(compgen -W 'hybrid eulerian lagrangian' -- "$word")); return ;;
        --thickness.layer-kind) COMPREPLY=($(compgen -W 'depth volume' -- "$word")); return ;;
        --surface.surface-space) COMPREPLY=($(compgen -W 'stated scanner tkr' -- "$word")); return ;;
        --surface.xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --surface.preset) COMPREPLY=($(compgen -W 'auto aseg ribbon three-class wm none' -- "$word")); return ;;
        --surface.hemisphere) COMPREPLY=($(compgen -W 'L R' -- "$word")); return ;;
        --surface.genus) COMPREPLY=($(compgen -W 'zero keep' -- "$word")); return ;;
        --unfold.surface-space) COMPREPLY=($(compgen -W 'stated scanner tkr' -- "$word")); return ;;
        --unfold.metric) COMPREPLY=($(compgen -W 'euclidean geodesic' -- "$word")); return ;;
        --unfold.surround) COMPREPLY=($(compgen -W 'fixed elastic none' -- "$word")); return ;;
        --unfold.method) COMPREPLY=($(compgen -W 'implicit thesis' -- "$word")); return ;;
        --unfold.knot) COMPREPLY=($(compgen -W 'tree thesis-tree all-pairs off' -- "$word")); return ;;
      esac
      ;;
    'descriptors')
      options=' --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'embed')
      options=' --fit --average --combine --xform --frame --label --slice --contour --edges --smooth --centre --inner-radius --outer-radius --order --band --annulus --inner --tissue --samples --max-iterations --fit-step --smoothness --grid --frames --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
      esac
      ;;
    'history')
      options=' --config --threads --quiet --verbose --log --help --version'
      ;;
    'phantom cortex')
      options=' --size --spacing --thickness --depth --waves --noise --bias --seed --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'phantom eccentric')
      options=' --size --spacing --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'phantom polygon19')
      options=' --spacing --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'phantom polygon34')
      options=' --spacing --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'phantom shell')
      options=' --size --spacing --inner-radius --outer-radius --aspect --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'phantom spheroid')
      options=' --size --spacing --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'phantom ventricle')
      options=' --size --spacing --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'polygon')
      options=' --phantom --xform --frame --label --slice --contour --edges --smooth --region --viewpoint --direction --distance --view-line --method --surround --collar --no-length --no-topology --knot --knot-weight --target-visibility --max-iterations --max-time --visibility-gain --repulsion-gain --explicit-step --resume --frames --stages --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --phantom) COMPREPLY=($(compgen -W 'polygon19 polygon34' -- "$word")); return ;;
        --xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --method) COMPREPLY=($(compgen -W 'implicit thesis' -- "$word")); return ;;
        --surround) COMPREPLY=($(compgen -W 'fixed elastic none' -- "$word")); return ;;
        --knot) COMPREPLY=($(compgen -W 'tree all-pairs off' -- "$word")); return ;;
      esac
      ;;
    'replay')
      options=' --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'report')
      options=' --page --config --threads --quiet --verbose --log --help --version'
      ;;
    'run')
      options=' --atlas --kind --hemisphere --unfold-surface --given-surfaces --steps --resume --segment.mask --segment.atlas --segment.atlas-legend --segment.xform --segment.frame --segment.smooth --segment.bias-width --segment.max-iterations --segment.tolerance --segment.hemisphere --segment.core-depth --thickness.inner-level --thickness.outer-level --thickness.level --thickness.level-inside --thickness.xform --thickness.frame --thickness.inner --thickness.tissue --thickness.outer --thickness.insulated --thickness.boundary --thickness.open-ends --thickness.per-slice --thickness.sulci --thickness.facing --thickness.method --thickness.lambda --thickness.layers --thickness.layer-kind --thickness.grid --thickness.aha --thickness.rv-insertion --surface.inner-level --surface.outer-level --surface.grey-share --surface.insulated-mask --surface.level --surface.white-surface --surface.pial-surface --surface.mid-surface --surface.surface-space --surface.atlas --surface.atlas-legend --surface.parcellation --surface.xform --surface.frame --surface.preset --surface.white --surface.grey --surface.fill --surface.insulated --surface.hemisphere --surface.no-fill --surface.close-edges --surface.genus --surface.faces --surface.steps --surface.freesurfer --surface.fs-volume --unfold.surface-space --unfold.fs-volume --unfold.viewpoint --unfold.direction --unfold.distance --unfold.view-line --unfold.view-surface --unfold.center --unfold.vertex --unfold.radius --unfold.metric --unfold.cone --unfold.label --unfold.label-key --unfold.adjust-region --unfold.repair --unfold.surround --unfold.collar-rings --unfold.contact-range --unfold.largest-move --unfold.method --unfold.knot --unfold.keep-areas --unfold.time-step --unfold.area-weight --unfold.spring-weight --unfold.knot-weight --unfold.contact-weight --unfold.lift-weight --unfold.collar-weight --unfold.target-visibility --unfold.area-tolerance --unfold.max-iterations --unfold.max-time --unfold.frames --unfold.resume --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --kind) COMPREPLY=($(compgen -W 'auto t1 labels freesurfer bids' -- "$word")); return ;;
        --hemisphere) COMPREPLY=($(compgen -W 'L R' -- "$word")); return ;;
        --unfold-surface) COMPREPLY=($(compgen -W 'white mid pial' -- "$word")); return ;;
        --given-surfaces) COMPREPLY=($(compgen -W 'use remake' -- "$word")); return ;;
        --steps) COMPREPLY=($(compgen -W 'segment thickness surface unfold report' -- "$word")); return ;;
        --segment.xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --segment.hemisphere) COMPREPLY=($(compgen -W 'both L R' -- "$word")); return ;;
        --thickness.level-inside) COMPREPLY=($(compgen -W 'auto above below' -- "$word")); return ;;
        --thickness.xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --thickness.boundary) COMPREPLY=($(compgen -W 'subvoxel staircase embedding' -- "$word")); return ;;
        --thickness.sulci) COMPREPLY=($(compgen -W 'recover ignore' -- "$word")); return ;;
        --thickness.method) COMPREPLY=($(compgen -W 'hybrid eulerian lagrangian' -- "$word")); return ;;
        --thickness.layer-kind) COMPREPLY=($(compgen -W 'depth volume' -- "$word")); return ;;
        --surface.surface-space) COMPREPLY=($(compgen -W 'stated scanner tkr' -- "$word")); return ;;
        --surface.xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --surface.preset) COMPREPLY=($(compgen -W 'auto aseg ribbon three-class wm none' -- "$word")); return ;;
        --surface.hemisphere) COMPREPLY=($(compgen -W 'L R' -- "$word")); return ;;
        --surface.genus) COMPREPLY=($(compgen -W 'zero keep' -- "$word")); return ;;
        --unfold.surface-space) COMPREPLY=($(compgen -W 'stated scanner tkr' -- "$word")); return ;;
        --unfold.metric) COMPREPLY=($(compgen -W 'euclidean geodesic' -- "$word")); return ;;
        --unfold.surround) COMPREPLY=($(compgen -W 'fixed elastic none' -- "$word")); return ;;
        --unfold.method) COMPREPLY=($(compgen -W 'implicit thesis' -- "$word")); return ;;
        --unfold.knot) COMPREPLY=($(compgen -W 'tree thesis-tree all-pairs off' -- "$word")); return ;;
      esac
      ;;
    'segment')
      options=' --mask --atlas --atlas-legend --xform --frame --smooth --bias-width --max-iterations --tolerance --hemisphere --core-depth --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --hemisphere) COMPREPLY=($(compgen -W 'both L R' -- "$word")); return ;;
      esac
      ;;
    'study check')
      options=' --config --threads --quiet --verbose --log --help --version'
      ;;
    'study group')
      options=' --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
    'study list')
      options=' --todo --keys --config --threads --quiet --verbose --log --help --version'
      ;;
    'study participant')
      options=' --participant-label --config --threads --quiet --verbose --log --help --version'
      ;;
    'study schema')
      options=' --config --threads --quiet --verbose --log --help --version'
      ;;
    'surface')
      options=' --inner-level --outer-level --grey-share --insulated-mask --level --white-surface --pial-surface --mid-surface --surface-space --atlas --atlas-legend --parcellation --xform --frame --preset --white --grey --fill --insulated --hemisphere --no-fill --close-edges --genus --faces --steps --freesurfer --fs-volume --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --surface-space) COMPREPLY=($(compgen -W 'stated scanner tkr' -- "$word")); return ;;
        --xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --preset) COMPREPLY=($(compgen -W 'auto aseg ribbon three-class wm none' -- "$word")); return ;;
        --hemisphere) COMPREPLY=($(compgen -W 'L R' -- "$word")); return ;;
        --genus) COMPREPLY=($(compgen -W 'zero keep' -- "$word")); return ;;
      esac
      ;;
    'thickness')
      options=' --inner-level --outer-level --level --level-inside --xform --frame --inner --tissue --outer --insulated --boundary --open-ends --per-slice --sulci --facing --method --lambda --layers --layer-kind --grid --aha --rv-insertion --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --level-inside) COMPREPLY=($(compgen -W 'auto above below' -- "$word")); return ;;
        --xform) COMPREPLY=($(compgen -W 'agreed qform sform none' -- "$word")); return ;;
        --boundary) COMPREPLY=($(compgen -W 'subvoxel staircase embedding' -- "$word")); return ;;
        --sulci) COMPREPLY=($(compgen -W 'recover ignore' -- "$word")); return ;;
        --method) COMPREPLY=($(compgen -W 'hybrid eulerian lagrangian' -- "$word")); return ;;
        --layer-kind) COMPREPLY=($(compgen -W 'depth volume' -- "$word")); return ;;
      esac
      ;;
    'unfold')
      options=' --surface-space --fs-volume --viewpoint --direction --distance --view-line --view-surface --center --vertex --radius --metric --cone --label --label-key --adjust-region --repair --surround --collar-rings --contact-range --largest-move --method --knot --keep-areas --time-step --area-weight --spring-weight --knot-weight --contact-weight --lift-weight --collar-weight --target-visibility --area-tolerance --max-iterations --max-time --frames --resume --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      case $previous in
        --surface-space) COMPREPLY=($(compgen -W 'stated scanner tkr' -- "$word")); return ;;
        --metric) COMPREPLY=($(compgen -W 'euclidean geodesic' -- "$word")); return ;;
        --surround) COMPREPLY=($(compgen -W 'fixed elastic none' -- "$word")); return ;;
        --method) COMPREPLY=($(compgen -W 'implicit thesis' -- "$word")); return ;;
        --knot) COMPREPLY=($(compgen -W 'tree thesis-tree all-pairs off' -- "$word")); return ;;
      esac
      ;;
    'verify')
      options=' --deep --prov-json --config --threads --quiet --verbose --log --help --version'
      ;;
    'view')
      options=' --screenshot --film --map --map-name --labels --region --views --direction --focus --colours --range --columns --slices --fps --width --height --samples --occlusion --vertex --radius --distance --surround --save --script --surface-space --fs-volume --config --threads --quiet --verbose --log --help --version'
      case $previous in
        --views) COMPREPLY=($(compgen -W 'left right front back top bottom' -- "$word")); return ;;
        --colours) COMPREPLY=($(compgen -W 'sequential heat diverging grey' -- "$word")); return ;;
        --surround) COMPREPLY=($(compgen -W 'fixed elastic none' -- "$word")); return ;;
        --surface-space) COMPREPLY=($(compgen -W 'stated scanner tkr' -- "$word")); return ;;
      esac
      ;;
  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
  else
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}
complete -o filenames -F _explica explica
