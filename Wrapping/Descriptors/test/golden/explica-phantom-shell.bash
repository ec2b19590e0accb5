    'phantom shell')
      files=''
      first='--size --spacing --inner-radius --outer-radius --aspect --out'
      options='--size --spacing --inner-radius --outer-radius --aspect --out --force --config --threads --max-time --max-memory --dry-run --quiet --verbose --log --private --report --help --help-all --version'
      case $previous in
        --size|--spacing|--inner-radius|--outer-radius|--aspect|--threads|--max-time|--max-memory) values='-W' ;;
        --out) values='-d' ;;
        --config|--log) values='-f' ;;
      esac
      ;;
