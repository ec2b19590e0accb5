    'phantom shell')
      options=' --size --spacing --inner-radius --outer-radius --aspect --out --force --config --threads --dry-run --quiet --verbose --log --private --help --version'
      ;;
